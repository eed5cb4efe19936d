// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

namespace greville
{
  /**
   * Collective. Return the parameters of the parts of CoupledSimulations: one
   * part for each group of bodies on a common grid, if there are grids of
   * bodies or contacts; otherwise only the given parameters.
   *
   * In total Lagrangian steps, a part has only the cells of its grid that
   * contain points, and p more on each side, so that all functions that reach
   * its bodies are functions of the whole grid. Walls act on the sides of the
   * part that are sides of the grid of the parameters; all other sides are
   * free.
   *
   * Throws dealii::ExcMessage if a body is invalid.
   */
  template <int dim>
  std::vector<SimulationParameters>
  split_by_grids(const SimulationParameters &parameters, const MPI_Comm comm);
} // namespace greville

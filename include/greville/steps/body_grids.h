// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

namespace greville
{
  /**
   * Collective. Return the parameters of the parts of CoupledSimulations: one
   * part for each group of bodies on a common grid, if bodies have their own
   * grids or there are contacts; otherwise only the given parameters.
   *
   * In total Lagrangian steps, the grid of a part contains only the cells with
   * points and p more on each side, so that each function of its bodies is
   * complete. Walls act on sides of the part that are also sides of the
   * original grid; all other sides are free.
   *
   * Throws dealii::ExcMessage if a body is invalid.
   */
  template <int dim>
  std::vector<SimulationParameters>
  split_by_grids(const SimulationParameters &parameters, const MPI_Comm comm);
} // namespace greville

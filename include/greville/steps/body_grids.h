// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_body_grids_h
#define greville_steps_body_grids_h

#include <greville/parameters/simulation_parameters.h>

namespace greville
{
  /**
   * Collective. The simulations that CoupledSimulations consists of: one of
   * each body where bodies have grids of their own, and otherwise the one that
   * is given.
   *
   * A body gets the part of its grid around it: the cells with points and p
   * more on each side, so that all functions that reach the body are the
   * functions of the whole grid. Walls act on the sides of the part that are
   * sides of the grid; all other sides are free, as well as contact walls,
   * beyond which the grid continues.
   *
   * Throws dealii::ExcMessage if a body is invalid.
   */
  template <int dim>
  std::vector<SimulationParameters>
  split_by_grids(const SimulationParameters &parameters, const MPI_Comm comm);
} // namespace greville

#endif

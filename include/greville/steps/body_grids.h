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
   * A body gets the part around it of the grid that is meant for it: the cells
   * that hold points and p more on each side. All functions that reach the body
   * are those of the whole grid then. Walls act on the sides of the part that
   * are sides of the grid; all others are free, and so are those that contacts
   * name, behind which the grid goes on.
   *
   * Throws dealii::ExcMessage where a body is wrong.
   */
  template <int dim>
  std::vector<SimulationParameters>
  split_by_grids(const SimulationParameters &parameters, const MPI_Comm comm);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_run_header_h
#define greville_run_run_header_h

#include <greville/steps/ensemble.h>

#include <ostream>

namespace greville
{
  /**
   * Write what runs begin with: bodies, points, grid, and print_stage().
   */
  template <int dim>
  void
  print_header(std::ostream               &out,
               const Ensemble<dim>        &ensemble,
               const SimulationParameters &parameters,
               const MPI_Comm              comm);

  /**
   * Write how the stage at hand goes on, and its solvers.
   */
  template <int dim>
  void
  print_stage(std::ostream               &out,
              const Ensemble<dim>        &ensemble,
              const SimulationParameters &parameters);
} // namespace greville

#endif

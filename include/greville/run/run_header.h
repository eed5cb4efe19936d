// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_run_header_h
#define greville_run_run_header_h

#include <greville/steps/coupled_simulations.h>

#include <ostream>

namespace greville
{
  /**
   * Write what runs begin with: bodies, points, grid, and print_stage().
   */
  template <int dim>
  void
  print_header(std::ostream                  &out,
               const CoupledSimulations<dim> &simulations,
               const SimulationParameters    &parameters,
               const MPI_Comm                 comm);

  /**
   * Write how the stage at hand goes on, and its solvers.
   */
  template <int dim>
  void
  print_stage(std::ostream                  &out,
              const CoupledSimulations<dim> &simulations,
              const SimulationParameters    &parameters);

  /**
   * Collective. How much of the initial state of bodies with an initial stress
   * is not in balance: sum |f_i|, N (2D: N / m), over the functions of the grid
   * that walls do not hold, with the force f_i by stresses, gravity and loads,
   * and its part of the weight of all bodies. Nothing where friction walls or
   * contacts would carry them. Returns a note if it is more than bodies without
   * stresses have, and else nothing.
   */
  template <int dim>
  std::string
  print_imbalance(std::ostream               &out,
                  CoupledSimulations<dim>    &simulations,
                  const SimulationParameters &parameters,
                  const MPI_Comm              comm);
} // namespace greville

#endif

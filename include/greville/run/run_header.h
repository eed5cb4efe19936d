// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/coupled_simulations.h>

#include <ostream>

namespace greville
{
  /// Write the header of a run: bodies, points and grid, then print_stage().
  template <int dim>
  void
  print_header(std::ostream                  &out,
               const CoupledSimulations<dim> &simulations,
               const SimulationParameters    &parameters,
               const MPI_Comm                 comm);

  /// Write the time integration of the current stage and its solvers.
  template <int dim>
  void
  print_stage(std::ostream                  &out,
              const CoupledSimulations<dim> &simulations,
              const SimulationParameters    &parameters);

  /**
   * Collective. Write the imbalance of bodies with an initial stress: sum
   * |f_i|, N (2D: N / m), over the grid functions that walls do not constrain,
   * with the force f_i of stresses, gravity and loads, and its ratio to the
   * weight of all bodies. Writes nothing if friction walls or contacts would
   * carry the forces. Returns a note if the imbalance is larger than without
   * stresses, else nothing.
   */
  template <int dim>
  std::string
  print_imbalance(std::ostream               &out,
                  CoupledSimulations<dim>    &simulations,
                  const SimulationParameters &parameters,
                  const MPI_Comm              comm);
} // namespace greville

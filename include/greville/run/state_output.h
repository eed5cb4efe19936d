// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_state_output_h
#define greville_run_state_output_h

#include <greville/run/output.h>
#include <greville/steps/coupled_simulations.h>

namespace greville
{
  /**
   * Return the name in files of a part of the @p simulations: its body if there
   * are several parts, else nothing.
   */
  template <int dim>
  std::string
  name_of_part(const CoupledSimulations<dim> &simulations,
               const unsigned int             part);

  /**
   * Collective. Return the current states of the parts, with the loads of
   * surfaces.
   */
  template <int dim>
  std::vector<const State<dim> *>
  loaded_states(CoupledSimulations<dim> &simulations);

  /**
   * Collective. Write the points, the surfaces that carry loads or are in
   * contact, and the rigid bodies of the @p simulations with these @p states.
   * Throws dealii::ExcMessage if a file cannot be written.
   */
  template <int dim>
  void
  write_bodies(FieldOutput<dim>                      &output,
               const CoupledSimulations<dim>         &simulations,
               const std::vector<const State<dim> *> &states,
               const SimulationParameters            &parameters,
               const MPI_Comm                         comm);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_ensemble_output_h
#define greville_run_ensemble_output_h

#include <greville/run/output.h>
#include <greville/steps/ensemble.h>

namespace greville
{
  /**
   * What the files of an ensemble call a part of it: its body where there are
   * several parts, and nothing else.
   */
  template <int dim>
  std::string
  name_of_part(const Ensemble<dim> &ensemble, const unsigned int part);

  /**
   * Collective. The states of the parts as they are, with the loads of
   * surfaces.
   */
  template <int dim>
  std::vector<const State<dim> *>
  loaded_states(Ensemble<dim> &ensemble);

  /**
   * Collective. Write the points, the surfaces that carry loads or are in
   * contact, and the rigid bodies of an ensemble with these @p states. Throws
   * dealii::ExcMessage where a file cannot be written.
   */
  template <int dim>
  void
  write_bodies(FieldOutput<dim>                      &output,
               const Ensemble<dim>                   &ensemble,
               const std::vector<const State<dim> *> &states,
               const SimulationParameters            &parameters,
               const MPI_Comm                         comm);
} // namespace greville

#endif

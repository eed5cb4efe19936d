// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/run/output.h>
#include <greville/steps/coupled_simulations.h>

namespace greville
{
  /// Return the name in files of a part of the @p simulations: its body if
  /// there are several parts, else nothing.
  template <int dim>
  std::string
  name_of_part(const CoupledSimulations<dim> &simulations,
               const unsigned int             part);

  /// Return the number of the first body of a part in
  /// CoupledSimulations::bodies().
  template <int dim>
  unsigned int
  first_body_of_part(const CoupledSimulations<dim> &simulations,
                     const unsigned int             part);

  /// Collective. Write the points of a part, and its surfaces that carry loads
  /// or are in contact; with the first part, also the rigid bodies. The
  /// @p output must keep its files in memory, because parts share the file of
  /// points.
  template <int dim>
  void
  write_bodies(FieldOutput<dim>           &output,
               CoupledSimulations<dim>    &simulations,
               const unsigned int          part,
               const SimulationParameters &parameters,
               const MPI_Comm              comm);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// Collective. Return the partition that gives each process the same share of
  /// the points of the parameters and of the cells of @p mesh. It has no rows
  /// on one process.
  template <int dim>
  Partition
  initial_partition(DistributedTriangulation<dim> &mesh,
                    const SimulationParameters    &parameters,
                    const Loads<dim>              &loads);

  /// Collective. Refine cells of a refined mesh as regions with a 'Distance to
  /// surface' require, and until no function at their edges depends on the few
  /// points of cut cells only (LevelFunctions): bodies whose surfaces cross
  /// cells of several sizes have splines that are smooth.
  template <int dim>
  void
  refine_at_surfaces(DistributedTriangulation<dim> &mesh,
                     const SimulationParameters    &parameters,
                     const Loads<dim>              &loads);

  /// Collective. Return the largest speeds. Waves have the speed of stress-free
  /// bodies.
  template <int dim>
  Signals
  initial_signals(const std::vector<Body<dim>> &bodies,
                  const SplineSpace<dim>       &space);

  /// Collective. Set the signals of a state to the initial ones of its bodies,
  /// but not below the fastest ones so far.
  template <int dim>
  void
  renew_signals(State<dim> &state, const SplineSpace<dim> &space);

  /// Collective. Return the bodies with their points, at rest on the grid.
  /// Throws dealii::ExcMessage if two bodies overlap by half of a cell or more,
  /// or if an initial displacement moves points out of the grid. Points have
  /// the fields of all stages.
  template <int dim>
  State<dim>
  make_initial_state(const SimulationParameters &parameters,
                     const Loads<dim>           &loads,
                     Discretization<dim>        &discretization);

  /// Collective. Throw dealii::ExcMessage if the pressure of incompressible
  /// water is undetermined: bodies without drained boundaries fill a grid, and
  /// all walls of the grid constrain normal velocities. Otherwise, the total
  /// stress at a surface determines the pressure.
  template <int dim>
  void
  check_closed_box(const std::vector<Body<dim>> &bodies,
                   const SimulationParameters   &parameters,
                   const SplineSpace<dim>       &space);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_initial_state_h
#define greville_steps_initial_state_h

#include <greville/steps/discretization.h>

namespace greville
{
  /**
   * Collective. The partition that gives each process the same share of the
   * points, which the parameters describe, and of the cells of @p mesh. Without
   * rows on one process.
   */
  template <int dim>
  Partition
  initial_partition(DistributedTriangulation<dim> &mesh,
                    const SimulationParameters    &parameters,
                    const Loads<dim>              &loads);

  /**
   * Collective. The largest speeds, with waves as fast as those of bodies
   * without stress.
   */
  template <int dim>
  Signals
  initial_signals(const std::vector<Body<dim>> &bodies,
                  const SplineSpace<dim>       &space);

  /**
   * Collective. The bodies with their points, at rest on the grid. Throws
   * dealii::ExcMessage where two bodies fill the same cells, by half a cell or
   * more, and where an initial displacement moves points out of the grid.
   * Points have the fields of all stages.
   */
  template <int dim>
  State<dim>
  make_initial_state(const SimulationParameters &parameters,
                     const Loads<dim>           &loads,
                     Discretization<dim>        &discretization);

  /**
   * Collective. Throws dealii::ExcMessage where incompressible water has no
   * pressure: bodies without drained boundaries fill a grid whose walls all
   * hold their normals. Elsewhere the total stress of a surface gives it.
   */
  template <int dim>
  void
  check_closed_box(const std::vector<Body<dim>> &bodies,
                   const SimulationParameters   &parameters,
                   const SplineSpace<dim>       &space);
} // namespace greville

#endif

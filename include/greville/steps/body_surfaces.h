// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>
#include <greville/steps/state.h>

namespace greville
{
  /**
   * Collective. Return a function for GridParameters::hierarchy(); none if no
   * region has a 'Distance to surface'. The surface of a body are the cells of
   * the @p space with points of the body that have a neighbor without such
   * points, or whose points fill less than a half of the cell. If the bodies
   * @p are_new, all cells that they do not fill belong to the surface. Sides of
   * the grid do not count.
   *
   * Rigid bodies have the positions of @p rigid_bodies, or their initial ones
   * if this is empty. Cells of total Lagrangian steps are those of the initial
   * configuration.
   */
  template <int dim>
  IsNearSurface<dim>
  find_surfaces(const SimulationParameters             &parameters,
                const SplineSpace<dim>                 &space,
                const std::vector<Body<dim>>           &bodies,
                const std::vector<RigidBodyState<dim>> &rigid_bodies,
                const bool                              are_new);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/closest_surface.h>

#include <functional>

namespace greville::internal
{
  /// Return a closed mesh of the shape with the inside @p contains and the
  /// @p surface, within a box whose longest side has @p n_cells cells. Each
  /// cell with corners inside and outside has a vertex (@ref Ju2002 "Ju et al.,
  /// 2002") at the intersection of the planes that touch the surface at the
  /// cell's edges, so edges and corners are sharp. Parts thinner than a cell
  /// may be missed. Places where formulas have no value are outside.
  template <int dim>
  ClosedSurface<dim>
  dual_contours(const std::function<bool(const dealii::Point<dim> &)> &contains,
                const ClosestSurface<dim>                             &surface,
                const dealii::BoundingBox<dim>                        &box,
                const unsigned int                                     n_cells);
} // namespace greville::internal

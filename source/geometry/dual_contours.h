// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_dual_contours_h
#define greville_geometry_dual_contours_h

#include <greville/geometry/closest_surface.h>

#include <functional>

namespace greville::internal
{
  /**
   * A closed mesh of what @p contains says, which has the @p surface, within a
   * box whose longest side has @p n_cells cells: each cell with corners inside
   * and outside has a vertex (@ref Ju2002 "Ju et al., 2002"), where the planes
   * meet that touch the surface at its edges, so that edges and corners are
   * sharp. What is thinner than a cell may be missed. Where formulas have no
   * value nothing is inside.
   */
  template <int dim>
  ClosedSurface<dim>
  dual_contours(const std::function<bool(const dealii::Point<dim> &)> &contains,
                const ClosestSurface<dim>                             &surface,
                const dealii::BoundingBox<dim>                        &box,
                const unsigned int                                     n_cells);
} // namespace greville::internal

#endif

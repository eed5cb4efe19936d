// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/vector_field.h>
#include <greville/points/material_points.h>
#include <greville/points/spline_polynomials.h>

#include <vector>

namespace greville
{
  /**
   * Collective. Return the values of a spline with these coefficients at the
   * points of each of the @p surfaces, in their order. The spline may have
   * larger cells: owned cell c of the points lies in owned cell parents[c] of
   * the spline, with the @p parents.
   *
   * Basis functions are evaluated as for the points; in total Lagrangian steps,
   * this is the initial configuration. If a material point with the radius R
   * faces another surface (see Surface), the surface of its body is ahead of
   * it. Its value is then @f$p + R \, n \cdot \nabla p@f$, which is exact for
   * water at rest.
   */
  template <int dim>
  std::vector<std::vector<double>>
  values_at_surfaces(const SpacePolynomials<dim>     &tables,
                     const std::vector<unsigned int> &parents,
                     const VectorType                &coefficients,
                     const std::vector<const MaterialPoints<dim> *> &surfaces);
} // namespace greville

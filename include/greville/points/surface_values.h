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
   * points of each of the @p surfaces, in their order. The cells of the spline
   * are the @p parents of the points' cells: owned cell c lies in owned cell
   * parents[c].
   *
   * Basis functions are evaluated as for the points, in total Lagrangian steps
   * in the initial configuration. The surface of a material point with the
   * radius R that faces another surface (see Surface) is ahead of the point, so
   * its value is @f$p + R \, n \cdot \nabla p@f$, which is exact for water at
   * rest.
   */
  template <int dim>
  std::vector<std::vector<double>>
  values_at_surfaces(const SpacePolynomials<dim>     &tables,
                     const std::vector<unsigned int> &parents,
                     const VectorType                &coefficients,
                     const std::vector<const MaterialPoints<dim> *> &surfaces);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/convex_part.h>

namespace greville
{
  /// Return the number of linearly independent polynomials of total degree at
  /// most @p degree.
  template <int dim>
  unsigned int
  n_polynomials(const unsigned int degree);

  /// Reduce the points to at most n_polynomials() with new positive weights.
  /// Integrals of polynomials of total degree @p degree do not change (V.
  /// Tchakaloff's theorem). Points are removed one after another: the weights
  /// move along a vector that is orthogonal to all polynomials until the first
  /// weight is zero.
  template <int dim>
  void
  compress_quadrature(std::vector<WeightedPoint<dim>> &points,
                      const unsigned int               degree);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_compressed_quadrature_h
#define greville_geometry_compressed_quadrature_h

#include <greville/geometry/convex_part.h>

namespace greville
{
  /**
   * The number of polynomials of total degree @p degree at most that are
   * linearly independent.
   */
  template <int dim>
  unsigned int
  n_polynomials(const unsigned int degree);

  /**
   * Keep at most n_polynomials() of the points, with new positive weights, so
   * that integrals of polynomials of total degree @p degree do not change
   * (V. Tchakaloff's theorem). Points leave one after the other: the weights
   * move along a vector that no polynomial sees until the first one is zero.
   */
  template <int dim>
  void
  compress_quadrature(std::vector<WeightedPoint<dim>> &points,
                      const unsigned int               degree);
} // namespace greville

#endif

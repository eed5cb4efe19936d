// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/spline_space.h>

#include <array>
#include <vector>

namespace greville
{
  /// The univariate B-splines of all cells of a direction as polynomials, for
  /// kernels that evaluate them at any point.
  class SplinePolynomials
  {
  public:
    void
    reinit(const KnotVector &knots);

    /// Return the coefficients c in N_a = sum_k c[a (p+1) + k] t^k with t = (x
    /// - centre of the cell) / h.
    const double *
    coefficients(const unsigned int cell) const
    {
      return polynomials.data() + std::size_t(cell) * n * n;
    }

    /// Return the Greville abscissae of the functions of a cell minus its
    /// centre.
    const double *
    greville_offsets(const unsigned int cell) const
    {
      return offsets.data() + std::size_t(cell) * n;
    }

  private:
    unsigned int        n = 0;
    std::vector<double> polynomials, offsets;
  };

  /// The polynomials of all directions of a space.
  template <int dim>
  struct SpacePolynomials
  {
    /// The space is kept by reference.
    void
    reinit(const SplineSpace<dim> &given)
    {
      space = &given;
      for (unsigned int d = 0; d < dim; ++d)
        directions[d].reinit(given.knots(d));
    }

    const SplineSpace<dim>            *space = nullptr;
    std::array<SplinePolynomials, dim> directions;
  };
} // namespace greville

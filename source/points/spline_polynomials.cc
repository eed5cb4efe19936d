// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/full_matrix.h>

#include <greville/points/spline_polynomials.h>

namespace greville
{
  using namespace dealii;

  void
  SplinePolynomials::reinit(const KnotVector &knots)
  {
    n                          = knots.degree() + 1;
    const unsigned int n_cells = knots.n_elements();
    polynomials.resize(std::size_t(n_cells) * n * n);
    offsets.resize(std::size_t(n_cells) * n);

    // Interpolate at n points to obtain the polynomials.
    const QGauss<1>    nodes(n);
    FullMatrix<double> inverse(n, n);
    for (unsigned int q = 0; q < n; ++q)
      for (unsigned int k = 0; k < n; ++k)
        inverse(q, k) = std::pow(nodes.point(q)(0) - 0.5, k);
    inverse.gauss_jordan();

    std::vector<double> values(n);
    for (unsigned int e = 0; e < n_cells; ++e)
      {
        const double lower = knots.element_lower(e);
        const double h     = knots.element_upper(e) - lower;
        double      *c     = polynomials.data() + std::size_t(e) * n * n;
        std::fill(c, c + n * n, 0.);
        for (unsigned int q = 0; q < n; ++q)
          {
            knots.evaluate(e,
                           lower + h * nodes.point(q)(0),
                           0,
                           make_array_view(values));
            for (unsigned int a = 0; a < n; ++a)
              for (unsigned int k = 0; k < n; ++k)
                c[a * n + k] += inverse(k, q) * values[a];
          }
        for (unsigned int a = 0; a < n; ++a)
          offsets[std::size_t(e) * n + a] =
            knots.greville_abscissa(knots.first_function(e) + a) - lower -
            0.5 * h;
      }
  }
} // namespace greville

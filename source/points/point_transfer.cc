// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include "point_kernels.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  void
  SplinePolynomials::reinit(const KnotVector &knots)
  {
    n                          = knots.degree() + 1;
    const unsigned int n_cells = knots.n_elements();
    polynomials.resize(std::size_t(n_cells) * n * n);
    offsets.resize(std::size_t(n_cells) * n);

    // Interpolation at n points gives the polynomials.
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



  template <int dim>
  void
  PointTransfer<dim>::reinit(const SplineSpace<dim> &space)
  {
    tables.reinit(space);
  }



  template <int dim>
  void
  PointTransfer<dim>::filling(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    std::vector<double>                            &result) const
  {
    constexpr double largest_expansion = 1.5;
    double           cell_volume       = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      cell_volume *= tables.space->lattice().cell_size(d);
    result.assign(tables.space->owned_cells().size(), 0.);
    for (const MaterialPoints<dim> *points : bodies)
      for (const unsigned int cell : points->cells())
        {
          Simd sum = 0.;
          for (unsigned int g = points->first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points->next_group(g))
            {
              const double *group = points->group(g);
              Simd          volume =
                load(group + PointLayout<dim>::volume0 * simd_width);
              if (!points->layout().is_total_lagrangian())
                volume *=
                  min(max(load(group + PointLayout<dim>::J * simd_width),
                          Simd(1.)),
                      Simd(largest_expansion));
              sum += volume;
            }
          result[cell] += reduce(sum) / cell_volume;
        }
  }



  template <int dim>
  Tensor<1, dim>
  PointTransfer<dim>::spread(const unsigned int cell, const Point<dim> &x) const
  {
    const SplineSpace<dim> &space   = *tables.space;
    const auto             &lattice = space.lattice();
    const unsigned int      n       = space.degree() + 1;
    const auto              index =
      multi_index<dim>(space.owned_cells()[cell], lattice.n_cells());
    const Point<dim> center = lattice.cell_center(index);
    Tensor<1, dim>   result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double *c       = tables.directions[d].coefficients(index[d]);
        const double *offsets = tables.directions[d].greville_offsets(index[d]);
        const double  t       = (x[d] - center[d]) / lattice.cell_size(d);
        for (unsigned int a = 0; a < n; ++a)
          {
            double N = 0.;
            for (int k = n - 1; k >= 0; --k)
              N = N * t + c[a * n + k];
            result[d] += N * std::pow(center[d] + offsets[a] - x[d], 2);
          }
      }
    return result;
  }



  template class PointTransfer<2>;
  template class PointTransfer<3>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/mass/density_weights.h>
#include <greville/mass/stencil_matrix.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return N_a(x_q) N_b(x_q) for all pairs a <= b of functions of an
    /// element, points fastest.
    std::vector<double>
    products_of_pairs(const KnotVector    &knots,
                      const unsigned int   element,
                      const Quadrature<1> &points,
                      const unsigned int   n)
    {
      const double        lower = knots.element_lower(element);
      const double        h     = knots.element_upper(element) - lower;
      const unsigned int  n_q   = points.size();
      std::vector<double> values(n_q * n), result;
      for (unsigned int q = 0; q < n_q; ++q)
        knots.evaluate(element,
                       lower + h * points.point(q)(0),
                       0,
                       ArrayView<double>(&values[q * n], n));
      for (unsigned int a = 0; a < n; ++a)
        for (unsigned int b = a; b < n; ++b)
          for (unsigned int q = 0; q < n_q; ++q)
            result.push_back(values[q * n + a] * values[q * n + b]);
      return result;
    }
  } // namespace



  template <int dim>
  void
  add_mass_matrix(StencilMatrix<dim>        &matrix,
                  const DensityWeights<dim> &weights)
  {
    const SplineSpace<dim> &space   = matrix.space();
    const unsigned int      n       = space.degree() + 1;
    const unsigned int      n_pairs = n * (n + 1) / 2;
    const unsigned int      n_q     = weights.n_points_1d();
    const QGauss<1>         gauss(n_q);

    std::array<std::vector<std::vector<double>>, dim> tables;
    for (unsigned int d = 0; d < dim; ++d)
      tables[d].resize(space.cells_per_direction()[d]);
    std::vector<double> from, to;
    for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
      {
        from.resize(weights.n_points());
        for (unsigned int q = 0; q < from.size(); ++q)
          from[q] = weights.at_cell(c)[q * CellBatches<dim>::width()];
        if (std::all_of(from.begin(), from.end(), [](const double w) {
              return w == 0.;
            }))
          continue;
        // Transform values at points to sums for pairs, direction by direction.
        const MultiIndex<dim> index  = space.box(c).index;
        unsigned int          n_done = 1, n_left = from.size();
        for (unsigned int d = 0; d < dim; ++d, n_done *= n_pairs)
          {
            auto &table = tables[d][index[d]];
            if (table.empty())
              table = products_of_pairs(space.knots(d), index[d], gauss, n);
            n_left /= n_q;
            to.assign(n_left * n_pairs * n_done, 0.);
            for (unsigned int k = 0; k < n_left; ++k)
              for (unsigned int pair = 0; pair < n_pairs; ++pair)
                for (unsigned int q = 0; q < n_q; ++q)
                  for (unsigned int i = 0; i < n_done; ++i)
                    to[(k * n_pairs + pair) * n_done + i] +=
                      table[pair * n_q + q] * from[(k * n_q + q) * n_done + i];
            from.swap(to);
          }
        matrix.add_cell(c, from.data());
      }
  }



  GREVILLE_INSTANTIATE(add_mass_matrix);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/stencil_matrix.h>

#include "point_kernels.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * sum[k] += sum_p factors[k][p] x[p] for vectors sum[k] and x[p] that are
     * @p stride numbers apart.
     */
    template <int n, int stride>
    inline void
    add_products(double *sum,
                 const double (&factors)[n][simd_width],
                 const double *x)
    {
      // As many sums at a time as there are registers for.
      constexpr int n_sums = n % 7 == 0   ? 7
                             : n % 6 == 0 ? 6
                             : n % 5 == 0 ? 5
                                          : n;
#pragma GCC unroll 4
      for (int first = 0; first < n; first += n_sums)
        {
          Simd part[n_sums];
#pragma GCC unroll 7
          for (int k = 0; k < n_sums; ++k)
            part[k] = load(sum + (first + k) * stride);
#pragma GCC unroll 8
          for (unsigned int p = 0; p < simd_width; ++p)
            {
              const Simd x_p = load(x + p * stride);
#pragma GCC unroll 7
              for (int k = 0; k < n_sums; ++k)
                part[k] += factors[first + k][p] * x_p;
            }
#pragma GCC unroll 7
          for (int k = 0; k < n_sums; ++k)
            store(part[k], sum + (first + k) * stride);
        }
    }



    /**
     * Add the mass matrices of the cells: for all pairs of functions in each
     * direction sum_p m_p N_a N_b. Shape functions have points in the lanes,
     * the sums have pairs in x, so that they need not be added up over lanes.
     */
    template <int dim, int n>
    void
    add_cells(const MaterialPoints<dim>   &points,
              const SpacePolynomials<dim> &tables,
              StencilMatrix<dim>          &matrix)
    {
      using Layout           = PointLayout<dim>;
      constexpr int n_pairs  = n * (n + 1) / 2;
      constexpr int n_outer  = dim == 3 ? n_pairs : 1;
      constexpr int width    = simd_width;
      constexpr int n_blocks = (n_pairs + width - 1) / width;
      constexpr int stride   = n_blocks * width;

      std::vector<double> sums(n_outer * n_pairs * stride);
      double              factors[n_pairs][width];       // m N_y N_y N_z N_z
      double              pairs_x[width][stride] = {{}}; // N_x N_x of a point
      const std::vector<unsigned int> &cells     = points.cells();
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const unsigned int         cell = cells[c];
          const CellGeometry<dim, n> geometry(tables, cell);
          std::fill(sums.begin(), sums.end(), 0.);
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              prefetch_next(points, c, g, Layout::volume0);
              const double *group = points.group(g);
              Simd          x[dim];
              load_basis_positions(points, group, x);
              ShapeValues<dim, n> shape;
              shape.template evaluate<false>(geometry, x);
              const Simd m = load(group + Layout::mass * simd_width);

              Simd pairs[dim][n_pairs];
#pragma GCC unroll 3
              for (int d = 0; d < dim; ++d)
                {
                  int k = 0;
#pragma GCC unroll 6
                  for (int a = 0; a < n; ++a)
#pragma GCC unroll 6
                    for (int b = a; b < n; ++b)
                      pairs[d][k++] = shape.N[d][a] * shape.N[d][b];
                }
              for (int k = 0; k < n_pairs; ++k)
                for (int point = 0; point < width; ++point)
                  pairs_x[point][k] = pairs[0][k][point];
              for (int z = 0; z < n_outer; ++z)
                {
                  const Simd m_z = dim == 3 ? m * pairs[dim - 1][z] : m;
                  for (int y = 0; y < n_pairs; ++y)
                    store(m_z * pairs[1][y], factors[y]);
                  for (int block = 0; block < n_blocks; ++block)
                    {
                      double *sum = sums.data() + z * n_pairs * stride +
                                    std::size_t(block) * width;
                      add_products<n_pairs, stride>(sum,
                                                    factors,
                                                    pairs_x[0] + block * width);
                    }
                }
            }
          matrix.add_cell(cell, sums.data(), stride);
        }
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::add_mass_matrix(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    StencilMatrix<dim>                             &matrix) const
  {
    for (const MaterialPoints<dim> *points : bodies)
      with_order(tables.space->degree(), [&](const auto n) {
        add_cells<dim, decltype(n)::value>(*points, tables, matrix);
      });
  }



  template class PointTransfer<2>;
  template class PointTransfer<3>;
} // namespace greville

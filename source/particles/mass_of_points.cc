#include <greville/multigrid/stencil_matrix.h>
#include <greville/particles/point_kernels.h>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * Add the mass matrices of the cells: for all pairs of functions in each
     * direction sum_p m_p N_a N_b, with points in the lanes.
     */
    template <int dim, int n>
    void
    add_cells(const MaterialPoints<dim>                &points,
              const SplineSpace<dim>                   &space,
              const std::array<SplinePolynomials, dim> &tables,
              StencilMatrix<dim>                       &matrix)
    {
      using Layout              = PointLayout<dim>;
      constexpr int n_pairs     = n * (n + 1) / 2;
      constexpr int n_outer     = dim == 3 ? n_pairs : 1;
      constexpr int n_all_pairs = n_outer * n_pairs * n_pairs;

      std::vector<Simd>   sums(n_all_pairs);
      std::vector<double> reduced(n_all_pairs);
      for (const unsigned int cell : points.cells())
        {
          const CellGeometry<dim, n> geometry(space, tables, cell);
          for (Simd &sum : sums)
            sum = 0.;
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              const double *group = points.group(g);
              Simd          x[dim];
              load_numbers<dim>(group, Layout::position, x);
              Shape<dim, n> shape;
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
              Simd *sum = sums.data();
              for (int z = 0; z < n_outer; ++z)
                {
                  const Simd m_z = dim == 3 ? m * pairs[dim - 1][z] : m;
                  for (int y = 0; y < n_pairs; ++y, sum += n_pairs)
                    {
                      const Simd m_zy = m_z * pairs[1][y];
#pragma GCC unroll 21
                      for (int k = 0; k < n_pairs; ++k)
                        sum[k] += m_zy * pairs[0][k];
                    }
                }
            }
          for (int k = 0; k < n_all_pairs; ++k)
            reduced[k] = reduce(sums[k]);
          matrix.add_cell(cell, reduced.data());
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
      with_order(spline_space->degree(), [&](const auto n) {
        add_cells<dim, decltype(n)::value>(*points,
                                           *spline_space,
                                           tables,
                                           matrix);
      });
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
      cell_volume *= spline_space->lattice().cell_size(d);
    result.assign(spline_space->owned_cells().size(), 0.);
    for (const MaterialPoints<dim> *points : bodies)
      for (const unsigned int cell : points->cells())
        {
          Simd sum = 0.;
          for (unsigned int g = points->first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points->next_group(g))
            {
              const double *group = points->group(g);
              const Simd    J = load(group + PointLayout<dim>::J * simd_width);
              sum += load(group + PointLayout<dim>::volume0 * simd_width) *
                     min(max(J, Simd(1.)), Simd(largest_expansion));
            }
          result[cell] += reduce(sum) / cell_volume;
        }
  }



  template void
  PointTransfer<2>::add_mass_matrix(
    const std::vector<const MaterialPoints<2> *> &, StencilMatrix<2> &) const;
  template void
  PointTransfer<3>::add_mass_matrix(
    const std::vector<const MaterialPoints<3> *> &, StencilMatrix<3> &) const;
  template void
  PointTransfer<2>::filling(const std::vector<const MaterialPoints<2> *> &,
                            std::vector<double> &) const;
  template void
  PointTransfer<3>::filling(const std::vector<const MaterialPoints<3> *> &,
                            std::vector<double> &) const;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include "point_kernels.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * Call action(group, N) for all groups of points, where N(a) is the value
     * of function a of their cell, and then finish(functions) for the cell.
     */
    template <int dim, int n, typename Points, typename Action, typename Finish>
    void
    for_each_group(Points                      &points,
                   const SpacePolynomials<dim> &tables,
                   const Action                &action,
                   const Finish                &finish)
    {
      for (const unsigned int cell : points.cells())
        {
          const CellGeometry<dim, n> geometry(tables, cell);
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g))
            {
              Simd x[dim];
              load_basis_positions(points, points.group(g), x);
              ShapeValues<dim, n> shape;
              shape.template evaluate<false>(geometry, x);
              Simd N[power(n, dim)];
              shape.multiply(N);
              action(points.group(g), N, geometry.functions);
            }
          finish(geometry.functions);
        }
    }



    /**
     * V0, V0 (J - 1) and V0 |J - 1| of the points, per function.
     */
    template <int dim, int n>
    void
    add_volumes(const MaterialPoints<dim>   &points,
                const SpacePolynomials<dim> &tables,
                std::array<VectorType, 3>   &sums)
    {
      constexpr int n_functions = power(n, dim);
      Simd          cell_sums[n_functions][3];
      for (auto &three : cell_sums)
        for (Simd &sum : three)
          sum = 0.;
      for_each_group<dim, n>(
        points,
        tables,
        [&](const double *group, const Simd *N, const unsigned int *) {
          const Simd V = load(group + PointLayout<dim>::volume0 * simd_width);
          const Simd change =
            V * (load(group + PointLayout<dim>::J * simd_width) - 1.);
          const Simd size = abs(change);
          for (int a = 0; a < n_functions; ++a)
            {
              cell_sums[a][0] += V * N[a];
              cell_sums[a][1] += change * N[a];
              cell_sums[a][2] += size * N[a];
            }
        },
        [&](const unsigned int *functions) {
          for (int a = 0; a < n_functions; ++a)
            for (unsigned int k = 0; k < 3; ++k)
              {
                sums[k].local_element(functions[a]) += reduce(cell_sums[a][k]);
                cell_sums[a][k] = 0.;
              }
        });
    }



    /**
     * J += part (sum_a N_a w_a (J_a - 1) - (J - 1) sum_a N_a w_a).
     */
    template <int dim, int n>
    void
    mix(MaterialPoints<dim>         &points,
        const SpacePolynomials<dim> &tables,
        const VectorType            &changes,
        const VectorType            &weights,
        const double                 part)
    {
      for_each_group<dim, n>(
        points,
        tables,
        [&](double *group, const Simd *N, const unsigned int *functions) {
          Simd change = 0., weight = 0.;
          for (int a = 0; a < power(n, dim); ++a)
            {
              change += N[a] * changes.local_element(functions[a]);
              weight += N[a] * weights.local_element(functions[a]);
            }
          double    *address = group + PointLayout<dim>::J * simd_width;
          const Simd V = load(group + PointLayout<dim>::volume0 * simd_width);
          Simd       J = load(address);
          // Lanes without a point keep J = 1.
          where(V > 0., J) = J + part * (change - (J - 1.) * weight);
          store(J, address);
        },
        [](const unsigned int *) {});
    }
  } // namespace



  template <int dim>
  void
  PointTransfer<dim>::share_volume(MaterialPoints<dim> &points,
                                   const double         part)
  {
    const SplineSpace<dim>   &space = *tables.space;
    std::array<VectorType, 3> sums;
    for (VectorType &sum : sums)
      space.initialize_vector(sum);
    with_order(space.degree(), [&](const auto size) {
      add_volumes<dim, decltype(size)::value>(points, tables, sums);
    });
    for (VectorType &sum : sums)
      sum.compress(VectorOperation::add);
    const VectorType &volumes = sums[0];
    VectorType       &changes = sums[1], &sizes = sums[2];
    for (unsigned int i = 0; i < volumes.locally_owned_size(); ++i)
      if (sizes.local_element(i) > 0.)
        {
          double      &change = changes.local_element(i);
          double      &size   = sizes.local_element(i);
          const double weight = 0.5 * (1. + change / size);
          change *= weight / volumes.local_element(i);
          size = weight;
        }
    changes.update_ghost_values();
    sizes.update_ghost_values();
    with_order(space.degree(), [&](const auto size) {
      mix<dim, decltype(size)::value>(points, tables, changes, sizes, part);
    });
  }



  template class PointTransfer<2>;
  template class PointTransfer<3>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/particles/volume_projection.h>

#include "gradients.h"
#include <cmath>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * Call visit(f, N_f(x)) for the functions of a cell, by local number.
     */
    template <int dim, int n, typename Visit>
    void
    for_each_value(const CellGeometry<dim, n> &cell,
                   const Point<dim>           &x,
                   const Visit                &visit)
    {
      double N[3][n];
      for (int d = 0; d < dim; ++d)
        {
          const double t = (x[d] - cell.center[d]) * cell.inverse_h[d];
          for (int a = 0; a < n; ++a)
            {
              const double *c = cell.polynomials[d] + a * n;
              N[d][a]         = c[n - 1];
              for (int k = n - 2; k >= 0; --k)
                N[d][a] = N[d][a] * t + c[k];
            }
        }
      for (int a_z = 0, a = 0; a_z < (dim == 3 ? n : 1); ++a_z)
        for (int a_y = 0; a_y < n; ++a_y)
          for (int a_x = 0; a_x < n; ++a_x, ++a)
            visit(cell.functions[a],
                  N[0][a_x] * N[1][a_y] * (dim == 3 ? N[2][a_z] : 1.));
    }



    /**
     * The factor of f for a change of volume theta.
     */
    template <int dim>
    double
    factor(const double projected, const double theta)
    {
      if (!(theta > 0. && projected > 0.))
        return 1.;
      return dim == 2 ? std::sqrt(projected / theta)
                      : std::cbrt(projected / theta);
    }
  } // namespace



  template <int dim>
  void
  VolumeProjection<dim>::reinit(const SplineSpace<dim>        &space,
                                DistributedTriangulation<dim> &triangulation)
  {
    tables.space = &space;
    for (unsigned int d = 0; d < dim; ++d)
      tables.directions[d].reinit(space.knots(d));
    if (space.degree() == 1)
      return;
    lower_space =
      std::make_unique<SplineSpace<dim>>(triangulation, space.degree() - 1);
    lower_tables.space = lower_space.get();
    for (unsigned int d = 0; d < dim; ++d)
      lower_tables.directions[d].reinit(lower_space->knots(d));
    for (VectorType *vector : {&weighted, &weight})
      lower_space->initialize_vector(*vector);
  }



  template <int dim>
  const std::vector<double> &
  VolumeProjection<dim>::factors(const MaterialPoints<dim> &points,
                                 const VectorField<dim>    &w,
                                 const double               dt)
  {
    const SplineSpace<dim> &space = *tables.space;
    buffer.resize(
      (space.owned_functions().size() + space.ghost_functions().size()) * dim);
    for (unsigned int d = 0; d < dim; ++d)
      put_into_buffer(w[d], dim, d, buffer);
    with_order(space.degree(), [&](const auto size) {
      constexpr int n = decltype(size)::value;
      find_changes<n>(points, dt);
      if constexpr (n == 2)
        average_in_cells<n>(points);
      else
        project<n - 1>(points);
    });
    return changes;
  }



  template <int dim>
  template <int n>
  void
  VolumeProjection<dim>::find_changes(const MaterialPoints<dim> &points,
                                      const double               dt)
  {
    constexpr int           n_functions = power(n, dim);
    const PointLayout<dim> &layout      = points.layout();
    changes.clear();
    changes.reserve(points.n_points());
    for (const unsigned int cell : points.cells())
      {
        const CellGeometry<dim, n> geometry(tables, cell);
        double                     coefficients[dim][n_functions];
        for (int a = 0; a < n_functions; ++a)
          for (int i = 0; i < dim; ++i)
            coefficients[i][a] =
              buffer[std::size_t(geometry.functions[a]) * dim + i];
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          const Gradients<dim, n> gradients(geometry, p.basis_position(layout));
          changes.push_back(determinant(increment_of_point<dim, n>(
            p, layout, gradients, coefficients, dt)));
        });
      }
  }



  template <int dim>
  template <int n>
  void
  VolumeProjection<dim>::average_in_cells(const MaterialPoints<dim> &points)
  {
    std::size_t first = 0;
    for (const unsigned int cell : points.cells())
      {
        double      volume = 0., sum = 0.;
        std::size_t k = first;
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          volume += p.volume();
          sum += p.volume() * changes[k++];
        });
        for (; first < k; ++first)
          changes[first] = factor<dim>(sum / volume, changes[first]);
      }
  }



  template <int dim>
  template <int n>
  void
  VolumeProjection<dim>::project(const MaterialPoints<dim> &points)
  {
    const unsigned int n_functions = lower_space->owned_functions().size() +
                                     lower_space->ghost_functions().size();
    sums.assign(n_functions * 2, 0.);
    const PointLayout<dim> &layout = points.layout();
    std::size_t             k      = 0;
    for (const unsigned int cell : points.cells())
      {
        const CellGeometry<dim, n> geometry(lower_tables, cell);
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          const double volume = p.volume(), theta = changes[k++];
          for_each_value<dim, n>(geometry,
                                 p.basis_position(layout),
                                 [&](const unsigned int f, const double N) {
                                   sums[2 * f] += volume * N;
                                   sums[2 * f + 1] += volume * N * theta;
                                 });
        });
      }
    take_from_buffer(sums, 2, 0, weight);
    take_from_buffer(sums, 2, 1, weighted);
    for (unsigned int i = 0; i < weight.locally_owned_size(); ++i)
      if (weight.local_element(i) > 0.)
        weighted.local_element(i) /= weight.local_element(i);
    sums.resize(n_functions);
    put_into_buffer(weighted, 1, 0, sums);
    k = 0;
    for (const unsigned int cell : points.cells())
      {
        const CellGeometry<dim, n> geometry(lower_tables, cell);
        points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          double projected = 0.;
          for_each_value<dim, n>(geometry,
                                 p.basis_position(layout),
                                 [&](const unsigned int f, const double N) {
                                   projected += sums[f] * N;
                                 });
          changes[k] = factor<dim>(projected, changes[k]);
          ++k;
        });
      }
  }



  template class VolumeProjection<2>;
  template class VolumeProjection<3>;
} // namespace greville

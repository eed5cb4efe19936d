// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_tangents.h>
#include <greville/points/trial_step.h>

#include "domains.h"
#include "gradients.h"
#include "group_gradients.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  template <int dim>
  void
  TrialSums<dim>::reinit(const SplineSpace<dim> &space,
                         const CellWindows<dim> *given)
  {
    tables.reinit(space);
    windows = given;
    clear();
  }



  template <int dim>
  void
  TrialSums<dim>::clear()
  {
    square = 0.;
    sums.assign(n_local_functions(*tables.space) * dim, 0.);
    if (windows)
      window_sums.assign(windows->n_places() * dim, 0.);
  }



  namespace
  {
    /// Add the forces, [function][component][lane], of a cell or its window to
    /// the @p sums of its functions, and return the sum of their squares.
    template <int dim, int n_functions>
    double
    add_sums_of_cell(const Simd         *force,
                     const unsigned int *functions,
                     double             *sums)
    {
      constexpr int n_padded = (n_functions * dim + 3) / 4 * 4;
      double        reduced[n_padded], square = 0.;
      for (int k = 0; k < n_padded; k += 4)
        store(reduce_four(force + k), reduced + k);
      for (int a = 0; a < n_functions; ++a)
        for (int i = 0; i < dim; ++i)
          {
            const double value = reduced[a * dim + i];
            sums[std::size_t(functions[a]) * dim + i] += value;
            square += value * value;
          }
      return square;
    }



    template <int dim, int n>
    double
    add_force_of_cell(const CellGeometry<dim, n>         &geometry,
                      const std::vector<TrialGroup<dim>> &groups,
                      double                             *sums)
    {
      using Shape = GroupGradients<dim, n, dim, dim == 2>;
      Simd force[Shape::n_padded];
      std::fill_n(force, Shape::n_padded, Simd(0.));
      for (const TrialGroup<dim> &group : groups)
        {
          Shape shape;
          Simd  T[Shape::n_pairs];
          std::copy_n(group.stress.begin(), Shape::n_pairs, T);
          shape.template evaluate<true>(geometry, group.x);
          shape.add_divergence(T, force);
        }
      return add_sums_of_cell<dim, power(n, dim)>(force,
                                                  geometry.functions,
                                                  sums);
    }



    /// Call @p add(geometry, group, force), which adds the forces of groups to
    /// the window of a cell, and return the sum of their squares.
    template <int dim, int n, typename Add>
    double
    add_forces_of_window(const WindowGeometry<dim, n>       &geometry,
                         const std::vector<TrialGroup<dim>> &groups,
                         double                             *sums,
                         const Add                          &add)
    {
      constexpr int n_functions = WindowShape<dim, n>::n_functions;
      Simd          force[(n_functions * dim + 3) / 4 * 4];
      for (Simd &sum : force)
        sum = 0.;
      for (const TrialGroup<dim> &group : groups)
        add(group, force);
      return add_sums_of_cell<dim, n_functions>(force,
                                                geometry.functions,
                                                sums);
    }



    /// Add @p factor T : grad N, and the pair of f_zz times N.
    template <int dim, int n>
    void
    add_divergence(const WindowShape<dim, n>             &shape,
                   const typename TrialGroup<dim>::Pairs &T,
                   const double                           factor,
                   Simd                                  *force)
    {
      Simd values[dim][dim];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          values[i][j] = factor * T[i * dim + j];
      shape.add_divergence(values, force);
      if constexpr (dim == 2)
        {
          const Simd hoop[dim] = {factor * T[dim * dim], Simd(0.)};
          shape.add_values(hoop, force);
        }
    }
  } // namespace



  template <int dim>
  void
  TrialSums<dim>::add_force(const unsigned int                  cell,
                            const std::vector<TrialGroup<dim>> &groups)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int n = decltype(size)::value;
      if (windows && windows->reaches(cell))
        {
          const WindowGeometry<dim, n> geometry(tables, *windows, cell);
          square += add_forces_of_window(
            geometry,
            groups,
            window_sums.data(),
            [&](const TrialGroup<dim> &group, Simd *force) {
              WindowShape<dim, n> shape;
              shape.evaluate(geometry, group.x, group.domain);
              add_divergence(shape, group.stress, 1., force);
            });
          return;
        }
      const CellGeometry<dim, n> geometry(tables, cell);
      square += add_force_of_cell<dim, n>(geometry, groups, sums.data());
    });
  }



  template <int dim>
  void
  TrialSums<dim>::add_change(const unsigned int                  cell,
                             const std::vector<TrialGroup<dim>> &groups,
                             const PointTangents<dim>           &tangents,
                             const std::vector<double>          &u)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int                n = decltype(size)::value;
      const WindowGeometry<dim, n> geometry(tables, *windows, cell);
      double in_window[WindowShape<dim, n>::n_functions * dim];
      read_window(geometry, u.data(), in_window);
      add_forces_of_window(
        geometry,
        groups,
        window_sums.data(),
        [&](const TrialGroup<dim> &group, Simd *force) {
          for (const bool at_point : {false, true})
            {
              Simd no_domain[dim];
              std::fill_n(no_domain, dim, Simd(0.));
              WindowShape<dim, n> shape;
              shape.evaluate(geometry,
                             group.x,
                             at_point ? no_domain : group.domain);
              Simd values[dim], H[dim][dim];
              shape.template evaluate_field<true>(in_window, values, H);
              typename TrialGroup<dim>::Pairs pairs, T;
              T.fill(0.);
              std::copy_n(H[0], dim * dim, pairs.begin());
              if constexpr (dim == 2)
                pairs[dim * dim] = values[0];
              tangents.multiply(group.tangent, pairs.data(), T.data());
              add_divergence(shape, T, at_point ? -1. : 1., force);
            }
        });
    });
  }



  template <int dim>
  void
  TrialSums<dim>::take_force(VectorField<dim> &force) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      take_from_buffer(sums, dim, d, force[d]);
    if (windows)
      windows->add_to(force, window_sums);
  }



  namespace
  {
    template <int dim, int n>
    double
    add_force_of_surface(const CellGeometry<dim, n>                &geometry,
                         const std::vector<TrialSurfacePoint<dim>> &points,
                         double                                    *sums)
    {
      double square                    = 0.;
      double force[power(n, dim)][dim] = {};
      for (const TrialSurfacePoint<dim> &point : points)
        {
          const ValuesAndGradients<dim, n> N(geometry, point.x);
          for (int a = 0; a < power(n, dim); ++a)
            for (int i = 0; i < dim; ++i)
              force[a][i] += point.area * point.load[i] * N.values[a];
        }
      for (int a = 0; a < power(n, dim); ++a)
        for (int i = 0; i < dim; ++i)
          {
            sums[std::size_t(geometry.functions[a]) * dim + i] += force[a][i];
            square += force[a][i] * force[a][i];
          }
      return square;
    }



    /// Return the derivative of a load on a point by the coefficients of a
    /// function.
    template <int dim, int n>
    double
    derivative(const TrialSurfacePoint<dim>     &point,
               const ValuesAndGradients<dim, n> &N,
               const int                         i,
               const int                         k,
               const int                         b)
    {
      double sum = point.by_displacement[i][k] * N.values[b];
      for (int L = 0; L < dim; ++L)
        sum += point.by_gradient[i][k][L] * N.gradients.values[L][b];
      return sum;
    }



    template <int dim, int n>
    void
    stiffness_of_surface(const CellGeometry<dim, n>                &geometry,
                         const std::vector<TrialSurfacePoint<dim>> &points,
                         float                                     *matrix)
    {
      constexpr int n_functions = power(n, dim);
      std::fill_n(matrix, dim * (dim + 1) / 2 * n_functions * n_functions, 0.f);
      for (const TrialSurfacePoint<dim> &point : points)
        {
          const ValuesAndGradients<dim, n> N(geometry, point.x);
          const double                     factor = -0.5 * point.area;
          float                           *entry  = matrix;
          for (int i = 0; i < dim; ++i)
            for (int k = i; k < dim; ++k)
              for (int a = 0; a < n_functions; ++a)
                for (int b = 0; b < n_functions; ++b)
                  *entry++ += float(
                    factor *
                    (N.values[a] * derivative<dim, n>(point, N, i, k, b) +
                     N.values[b] * derivative<dim, n>(point, N, k, i, a)));
        }
    }



    template <int dim, int n>
    void
    add_product_of_surface(const CellGeometry<dim, n>                &geometry,
                           const std::vector<TrialSurfacePoint<dim>> &points,
                           const std::array<std::size_t, power(n, dim)> &places,
                           const double                                 *x,
                           double                                       *y)
    {
      for (const TrialSurfacePoint<dim> &point : points)
        {
          const ValuesAndGradients<dim, n> N(geometry, point.x);
          for (int i = 0; i < dim; ++i)
            {
              double load = 0.;
              for (int b = 0; b < power(n, dim); ++b)
                for (int k = 0; k < dim; ++k)
                  load += derivative<dim, n>(point, N, i, k, b) *
                          x[places[b] * dim + k];
              for (int a = 0; a < power(n, dim); ++a)
                y[places[a] * dim + i] -= point.area * load * N.values[a];
            }
        }
    }
  } // namespace



  template <int dim>
  void
  TrialSums<dim>::add_force(const unsigned int                         cell,
                            const std::vector<TrialSurfacePoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      square += add_force_of_surface<dim, n>(geometry, points, sums.data());
    });
  }



  template <int dim>
  const float *
  TrialSums<dim>::stiffness(const unsigned int                         cell,
                            const std::vector<TrialSurfacePoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      matrix.resize(dim * (dim + 1) / 2 * power(n, 2 * dim));
      stiffness_of_surface<dim, n>(geometry, points, matrix.data());
    });
    return matrix.data();
  }



  template <int dim>
  void
  TrialSums<dim>::for_each_value(const unsigned int             cell,
                                 const std::vector<Point<dim>> &points,
                                 const Visit                   &visit) const
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      for (unsigned int k = 0; k < points.size(); ++k)
        {
          const ValuesAndGradients<dim, n> N(geometry, points[k]);
          for (int a = 0; a < power(n, dim); ++a)
            visit(k, geometry.functions[a], N.values[a]);
        }
    });
  }



  template <int dim>
  void
  TrialSums<dim>::add_product(double                   *y,
                              const double             *x,
                              const StencilMatrix<dim> &stencil,
                              const unsigned int        cell,
                              const std::vector<TrialSurfacePoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int                          n = decltype(size)::value;
      const CellGeometry<dim, n>             geometry(tables, cell);
      std::array<std::size_t, power(n, dim)> of_cell;
      for (int a = 0; a < power(n, dim); ++a)
        of_cell[a] = stencil.cell_place(cell, a % n, a / n);
      add_product_of_surface<dim, n>(geometry, points, of_cell, x, y);
    });
  }



  GREVILLE_INSTANTIATE_CLASS(TrialSums);
} // namespace greville

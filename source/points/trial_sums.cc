// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/trial_step.h>

#include "domains.h"
#include "gradients.h"

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
    sums.assign((tables.space->owned_functions().size() +
                 tables.space->ghost_functions().size()) *
                  dim,
                0.);
    if (windows)
      window_sums.assign(windows->n_places() * dim, 0.);
  }



  namespace
  {
    template <int dim, int n>
    double
    add_force_of_cell(const CellGeometry<dim, n>         &geometry,
                      const std::vector<TrialPoint<dim>> &points,
                      double                             *sums)
    {
      constexpr int n_functions             = power(n, dim);
      double        force[dim][n_functions] = {};
      for (const TrialPoint<dim> &point : points)
        {
          const auto              shape = evaluated(geometry, point.x);
          const Gradients<dim, n> gradients(shape);
          for (int i = 0; i < dim; ++i)
            for (int J = 0; J < dim; ++J)
              {
                const double P = point.volume * point.P[i][J];
                for (int a = 0; a < n_functions; ++a)
                  force[i][a] += P * gradients.values[J][a];
              }
          if (point.hoop.radius > 0.)
            {
              const double P = point.volume * point.hoop.P / point.hoop.radius;
              double       values[n_functions];
              shape.multiply(values);
              for (int a = 0; a < n_functions; ++a)
                force[0][a] += P * values[a];
            }
        }
      double square = 0.;
      for (int a = 0; a < n_functions; ++a)
        for (int i = 0; i < dim; ++i)
          {
            sums[std::size_t(geometry.functions[a]) * dim + i] += force[i][a];
            square += force[i][a] * force[i][a];
          }
      return square;
    }
  } // namespace



  namespace
  {
    /**
     * Call @p add(geometry, point, force) to add the forces of points on the
     * window of a cell, and return the sum of their squares.
     */
    template <int dim, int n, typename Add>
    double
    add_forces_of_window(const WindowGeometry<dim, n>       &geometry,
                         const std::vector<TrialPoint<dim>> &points,
                         double                             *sums,
                         const Add                          &add)
    {
      constexpr int n_values        = WindowShape<dim, n>::n_functions * dim;
      double        force[n_values] = {};
      for (const TrialPoint<dim> &point : points)
        add(point, force);
      double square = 0.;
      for (int k = 0; k < n_values; ++k)
        {
          sums[std::size_t(geometry.functions[k / dim]) * dim + k % dim] +=
            force[k];
          square += force[k] * force[k];
        }
      return square;
    }



    /**
     * Add V T : grad N.
     */
    template <int dim, typename Shape>
    void
    add_divergence(const Shape                  &shape,
                   const double                  volume,
                   const dealii::Tensor<2, dim> &T,
                   double                       *force)
    {
      double values[dim][dim];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          values[i][j] = volume * T[i][j];
      shape.add_divergence(values, force);
    }



    /**
     * Add @p factor V P_zz N / r to the component r, in axisymmetry.
     */
    template <int dim, typename Shape>
    void
    add_hoop(const Shape           &shape,
             const TrialPoint<dim> &point,
             const double           P,
             const double           factor,
             double                *force)
    {
      if (point.hoop.radius == 0.)
        return;
      double values[dim] = {factor * point.volume * P / point.hoop.radius};
      shape.add_values(values, force);
    }
  } // namespace



  template <int dim>
  void
  TrialSums<dim>::add_force(const unsigned int                  cell,
                            const std::vector<TrialPoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int n = decltype(size)::value;
      if (windows && windows->reaches(cell))
        {
          const WindowGeometry<dim, n> geometry(tables, *windows, cell);
          square += add_forces_of_window(
            geometry,
            points,
            window_sums.data(),
            [&](const TrialPoint<dim> &point, double *force) {
              const auto shape = evaluated(geometry, point.x, point.domain);
              add_divergence<dim>(shape, point.volume, point.P, force);
              add_hoop<dim>(shape, point, point.hoop.P, 1., force);
            });
          return;
        }
      const CellGeometry<dim, n> geometry(tables, cell);
      square += add_force_of_cell<dim, n>(geometry, points, sums.data());
    });
  }



  template <int dim>
  void
  TrialSums<dim>::add_change(const unsigned int                  cell,
                             const std::vector<TrialPoint<dim>> &points,
                             const std::vector<double>          &u)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int                n = decltype(size)::value;
      const WindowGeometry<dim, n> geometry(tables, *windows, cell);
      double in_window[WindowShape<dim, n>::n_functions * dim];
      read_window(geometry, u.data(), in_window);
      add_forces_of_window(
        geometry,
        points,
        window_sums.data(),
        [&](const TrialPoint<dim> &point, double *force) {
          for (const bool at_point : {false, true})
            {
              const auto shape =
                evaluated(geometry,
                          point.x,
                          at_point ? Tensor<1, dim>() : point.domain);
              double values[dim], H[dim][dim];
              shape.template evaluate_field<true>(in_window, values, H);
              // dP_iJ = map_Jj A_ijkl map_Ll H_kL.
              const Tensor<2, dim> df = Tensor<2, dim>(H) * point.map;
              Tensor<2, dim>       dP;
              for (unsigned int i = 0; i < dim; ++i)
                for (unsigned int j = 0; j < dim; ++j)
                  dP[i][j] = scalar_product(point.A[i][j], df);
              if (point.hoop.radius > 0.)
                {
                  const double df_hoop = values[0] / point.hoop.radius;
                  dP += df_hoop * point.hoop.by;
                  add_hoop<dim>(shape,
                                point,
                                point.hoop.A * df_hoop +
                                  scalar_product(point.hoop.of, df),
                                at_point ? -1. : 1.,
                                force);
                }
              add_divergence<dim>(shape,
                                  at_point ? -point.volume : point.volume,
                                  dP * transpose(point.map),
                                  force);
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



    /**
     * Return the derivative of a load on a point by the coefficients of a
     * function.
     */
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



  template class TrialSums<2>;
  template class TrialSums<3>;
} // namespace greville

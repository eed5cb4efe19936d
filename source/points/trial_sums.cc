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
    windows             = given;
    const std::size_t n = Utilities::fixed_power<dim>(space.degree() + 1) * dim;
    matrix.resize(n * n);
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



    /**
     * The stiffness of points, block by block of components, on vectors of
     * functions. Blocks of a symmetric matrix with i > k are the transposes of
     * others.
     */
    template <int dim, int n, bool symmetric>
    class CellStiffness
    {
    public:
      void
      sum_up(const CellGeometry<dim, n>         &geometry,
             const std::vector<TrialPoint<dim>> &points,
             std::vector<double>                &work,
             double                             *matrix)
      {
        work.assign(n_blocks * n_functions * n_padded, 0.);
        for (std::size_t first = 0; first < points.size(); first += n_together)
          {
            const unsigned int n_points =
              std::min<std::size_t>(n_together, points.size() - first);
            for (unsigned int q = 0; q < n_points; ++q)
              load(geometry, points[first + q], q);
            for (unsigned int q = n_points; q < n_together; ++q)
              std::fill_n(&gradients[q][0][0], dim * n_padded, 0.);
            double *block = work.data();
            for (int i = 0; i < dim; ++i)
              for (int k = symmetric ? i : 0; k < dim; ++k)
                {
                  for (unsigned int q = 0; q < n_points; ++q)
                    contract(points[first + q], i, k, q);
                  add(block);
                  block += n_functions * n_padded;
                }
          }
        write(work.data(), matrix);
      }

    private:
      static constexpr int n_functions = power(n, dim);
      static constexpr int width       = n_functions < 8 ? 4 : 8;
      static constexpr int n_padded = (n_functions + width - 1) / width * width;
      static constexpr int n_blocks =
        symmetric ? dim * (dim + 1) / 2 : dim * dim;
      // As many sums stay in registers until they are added.
      static constexpr int n_together = 4;

      using Vector = FixedSimd<double, width>;

      /**
       * The gradients at a point, mapped.
       */
      void
      load(const CellGeometry<dim, n> &geometry,
           const TrialPoint<dim>      &point,
           const unsigned int          q)
      {
        const Gradients<dim, n> at(geometry, point.x);
        for (int l = 0; l < dim; ++l)
          for (int a = 0; a < n_functions; ++a)
            {
              double sum = 0.;
              for (int L = 0; L < dim; ++L)
                sum += point.map[L][l] * at.values[L][a];
              gradients[q][l][a] = sum;
            }
      }

      /**
       * V A_ijkl d_j N_a.
       */
      void
      contract(const TrialPoint<dim> &point,
               const int              i,
               const int              k,
               const unsigned int     q)
      {
        for (int l = 0; l < dim; ++l)
          {
            double A[dim];
            for (int j = 0; j < dim; ++j)
              A[j] = point.volume * point.A[i][j][k][l];
            for (int a = 0; a < n_padded; ++a)
              {
                double sum = 0.;
                for (int j = 0; j < dim; ++j)
                  sum += A[j] * gradients[q][j][a];
                factors[q][l][a] = sum;
              }
          }
      }

      void
      add(double *block) const
      {
        for (int first = 0; first < n_padded; first += width)
          {
            Vector at[n_together][dim];
            for (int q = 0; q < n_together; ++q)
              for (int l = 0; l < dim; ++l)
                at[q][l].copy_from(&gradients[q][l][first],
                                   std::experimental::element_aligned);
            double *row = block + first;
            for (int a = 0; a < n_functions; ++a, row += n_padded)
              {
                Vector sum(row, std::experimental::element_aligned);
#pragma GCC unroll 4
                for (int q = 0; q < n_together; ++q)
#pragma GCC unroll 3
                  for (int l = 0; l < dim; ++l)
                    sum += factors[q][l][a] * at[q][l];
                sum.copy_to(row, std::experimental::element_aligned);
              }
          }
      }

      static void
      write(const double *block, double *matrix)
      {
        const auto at = [&](const int a, const int i, const int k) {
          return matrix + ((a * dim + i) * dim + k) * n_functions;
        };
        for (int i = 0; i < dim; ++i)
          for (int k = symmetric ? i : 0; k < dim; ++k)
            for (int a = 0; a < n_functions; ++a, block += n_padded)
              {
                std::copy_n(block, n_functions, at(a, i, k));
                if (symmetric && i != k)
                  for (int b = 0; b < n_functions; ++b)
                    at(b, k, i)[a] = block[b];
              }
      }

      // [point][direction][function], with zeros behind the functions.
      double gradients[n_together][dim][n_padded] = {};
      double factors[n_together][dim][n_padded]   = {};
    };
  } // namespace



  namespace
  {
    /**
     * Add to the stiffness of a cell what f_zz of axisymmetric points has of
     * it.
     */
    template <int dim, int n>
    void
    add_hoop_stiffness(const CellGeometry<dim, n>         &geometry,
                       const std::vector<TrialPoint<dim>> &points,
                       double                             *matrix)
    {
      constexpr int n_functions = power(n, dim);
      const auto    at          = [&](const int a, const int i, const int k) {
        return matrix + ((a * dim + i) * dim + k) * n_functions;
      };
      for (const TrialPoint<dim> &point : points)
        {
          const auto              shape = evaluated(geometry, point.x);
          const Gradients<dim, n> gradients(shape);
          const Tensor<2, dim>    of = point.hoop.of * transpose(point.map);
          const Tensor<2, dim>    by = point.hoop.by * transpose(point.map);
          double                  h[n_functions];       // df_zz by u_r
          double                  dP[dim][n_functions]; // of P_zz, by u_k
          shape.multiply(h);
          for (int b = 0; b < n_functions; ++b)
            h[b] /= point.hoop.radius;
          for (int k = 0; k < dim; ++k)
            for (int b = 0; b < n_functions; ++b)
              {
                dP[k][b] = k == 0 ? point.hoop.A * h[b] : 0.;
                for (int L = 0; L < dim; ++L)
                  dP[k][b] += of[k][L] * gradients.values[L][b];
              }
          for (int a = 0; a < n_functions; ++a)
            {
              for (int k = 0; k < dim; ++k)
                for (int b = 0; b < n_functions; ++b)
                  at(a, 0, k)[b] += point.volume * h[a] * dP[k][b];
              for (int i = 0; i < dim; ++i)
                {
                  double factor = 0.;
                  for (int J = 0; J < dim; ++J)
                    factor += point.volume * by[i][J] * gradients.values[J][a];
                  for (int b = 0; b < n_functions; ++b)
                    at(a, i, 0)[b] += factor * h[b];
                }
            }
        }
    }



    /**
     * Let @p add(geometry, point, force) add the forces of points on the window
     * of a cell, and return the sum of their squares.
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



  template <int dim>
  const double *
  TrialSums<dim>::stiffness(const unsigned int                  cell,
                            const std::vector<TrialPoint<dim>> &points,
                            const bool                          symmetric)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      if (symmetric)
        CellStiffness<dim, n, true>().sum_up(geometry,
                                             points,
                                             work,
                                             matrix.data());
      else
        CellStiffness<dim, n, false>().sum_up(geometry,
                                              points,
                                              work,
                                              matrix.data());
      if (!points.empty() && points[0].hoop.radius > 0.)
        add_hoop_stiffness<dim, n>(geometry, points, matrix.data());
    });
    return matrix.data();
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



    template <int dim, int n>
    void
    stiffness_of_surface(const CellGeometry<dim, n>                &geometry,
                         const std::vector<TrialSurfacePoint<dim>> &points,
                         double                                    *matrix)
    {
      constexpr int n_functions = power(n, dim);
      std::fill_n(matrix, n_functions * dim * n_functions * dim, 0.);
      for (const TrialSurfacePoint<dim> &point : points)
        {
          const ValuesAndGradients<dim, n> N(geometry, point.x);
          double                          *row = matrix;
          for (int a = 0; a < n_functions; ++a)
            for (int i = 0; i < dim; ++i)
              for (int k = 0; k < dim; ++k, row += n_functions)
                {
                  const double factor = -point.area * N.values[a];
                  for (int b = 0; b < n_functions; ++b)
                    {
                      double sum = point.by_displacement[i][k] * N.values[b];
                      for (int L = 0; L < dim; ++L)
                        sum +=
                          point.by_gradient[i][k][L] * N.gradients.values[L][b];
                      row[b] += factor * sum;
                    }
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
  const double *
  TrialSums<dim>::stiffness(const unsigned int                         cell,
                            const std::vector<TrialSurfacePoint<dim>> &points)
  {
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int              n = decltype(size)::value;
      const CellGeometry<dim, n> geometry(tables, cell);
      stiffness_of_surface<dim, n>(geometry, points, matrix.data());
    });
    return matrix.data();
  }



  template class TrialSums<2>;
  template class TrialSums<3>;
} // namespace greville

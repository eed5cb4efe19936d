// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/cell_windows.h>

#include "point_kernels.h"

/// B-splines of the windows of cells, averaged over boxes. To be included in
/// sources.
namespace greville
{
  namespace internal
  {
    /// Data shared by all points of a cell that uses its window.
    template <int dim, int n>
    struct WindowGeometry
    {
      WindowGeometry(const SpacePolynomials<dim> &tables,
                     const CellWindows<dim>      &windows,
                     const unsigned int           cell)
        : functions(windows.functions(cell))
        , averages_values(windows.averages_values())
      {
        const SplineSpace<dim> &space = *tables.space;
        const CellBox<dim>      box   = space.box(cell);
        for (unsigned int d = 0; d < dim; ++d)
          {
            const unsigned int index   = box.index[d];
            const unsigned int n_cells = space.cells_per_direction()[d];
            center[d]                  = box.center[d];
            inverse_h[d]               = 1. / box.size[d];
            largest_domain[d]          = 0.5 * space.smallest_near(d, index);
            for (unsigned int k = 0; k < 3; ++k)
              {
                const bool is_there = space.is_periodic(d) ||
                                      (index + k >= 1 && index + k <= n_cells);
                // Cells in a periodic direction are equal.
                const double size =
                  is_there && !space.is_periodic(d)
                    ? space.cell_size(d, index + k - 1) / box.size[d]
                    : 1.;
                scales[d][k]  = 1. / size;
                centers[d][k] = 0.5 * (1. + size) * (int(k) - 1);
                // Boxes end at the edges of the grid.
                if (k != 1)
                  ends[d][k / 2] = (is_there ? 0.5 + size : 0.5) * (int(k) - 1);
                polynomials[d][k] = is_there
                                      ? tables.directions[d].coefficients(
                                          (index + k + n_cells - 1) % n_cells)
                                      : nullptr;
              }
          }
      }

      double center[dim];
      double inverse_h[dim];
      double ends[dim][2];
      // Centers and inverse sizes of the three cells, in units of the middle
      // cell.
      double              centers[dim][3], scales[dim][3];
      double              largest_domain[dim]; // half edges
      const double       *polynomials[dim][3];
      const unsigned int *functions;
      bool                averages_values;
    };



    inline bool
    is_positive(const Simd &value)
    {
      return any_of(value > 0.);
    }

    /// Values and derivatives of the univariate functions of a window at a
    /// group of points, or at one point. Derivatives are averaged over domains,
    /// and values if the windows average them. Functions outside [first, last)
    /// are zero.
    template <int dim, int n, typename Number = Simd>
    struct WindowShape
    {
      static constexpr int n_1d        = n + 2;
      static constexpr int n_functions = power(n_1d, dim);

      void
      evaluate(const WindowGeometry<dim, n> &cell,
               const Number                 *x,
               const Number                 *s)
      {
        using std::max;
        using std::min;
        // The domain size, in cells, below which point values are used instead
        // of averages.
        constexpr double smallest = 1e-8;
        averages_values           = cell.averages_values;
#pragma GCC unroll 3
        for (int d = 0; d < dim; ++d)
          {
            const Number t = (x[d] - cell.center[d]) * cell.inverse_h[d];
            const Number r =
              max(Number(s[d] * cell.inverse_h[d]), Number(smallest));
            const Number lower = max(Number(t - r), Number(cell.ends[d][0]));
            const Number upper = min(Number(t + r), Number(cell.ends[d][1]));
            const Number scale = 1. / (upper - lower);
            first[d]           = 1;
            last[d]            = n + 1;
            for (int a = 0; a < n_1d; ++a)
              N[d][a] = dN[d][a] = 0.;
            for (int k = 0; k < 3; ++k)
              {
                const Number begin =
                  k == 0 ? lower : max(lower, Number(k - 1.5));
                const Number end = k == 2 ? upper : min(upper, Number(k - 0.5));
                const Number length = max(Number(end - begin), Number(0.));
                if (k == 0)
                  before[d] = length;
                if (k == 2)
                  behind[d] = length;
                if (k != 1 && !is_positive(length))
                  continue;
                if (k == 0)
                  first[d] = 0;
                if (k == 2)
                  last[d] = n_1d;
                const double center = cell.centers[d][k],
                             to_own = cell.scales[d][k];
                add_means<true>(cell.polynomials[d][k],
                                (begin - center) * to_own,
                                (end - center) * to_own,
                                length * scale,
                                cell.inverse_h[d] * to_own,
                                N[d] + k,
                                dN[d] + k);
              }
            if (!cell.averages_values)
              {
                for (int a = 0; a < n_1d; ++a)
                  N[d][a] = 0.;
                add_means<false>(
                  cell.polynomials[d][1], t, t, 1., 0., N[d] + 1, dN[d]);
              }
          }
      }

      /// Call action(number, factors, begin, end) for each row of functions
      /// along x. @p number belongs to its first function, the factors of the
      /// row are for derivatives in each direction, and [begin, end) is the
      /// range of functions to be used.
      template <typename Action>
      void
      for_each_row(const Action &action) const
      {
        for (int a_z = dim == 3 ? first[dim - 1] : 0;
             a_z < (dim == 3 ? last[dim - 1] : 1);
             ++a_z)
          for (int a_y = first[1]; a_y < last[1]; ++a_y)
            {
              // If values are not averaged, functions of neighbours have only
              // the derivative towards their cell.
              const bool at_z =
                averages_values || dim == 2 || (a_z > 0 && a_z <= n);
              const bool at_y = averages_values || (a_y > 0 && a_y <= n);
              if (!at_y && !at_z)
                continue;
              Number factors[dim];
              factors[0] = N[1][a_y];
              factors[1] = dN[1][a_y];
              if constexpr (dim == 3)
                {
                  factors[2] = factors[0] * dN[2][a_z];
                  factors[0] *= N[2][a_z];
                  factors[1] *= N[2][a_z];
                }
              const bool all = at_y && at_z;
              action((a_z * n_1d + a_y) * n_1d,
                     factors,
                     all ? first[0] : 1,
                     all ? last[0] : n + 1);
            }
      }

      /// Compute the field with coefficients u[function * dim + i], and its
      /// gradient H_ij = d_j u_i if @p with_gradient.
      template <bool with_gradient>
      void
      evaluate_field(const double *u,
                     Number (&field)[dim],
                     Number (&H)[dim][dim]) const
      {
        for (Number &component : field)
          component = 0.;
        if constexpr (with_gradient)
          for (auto &row : H)
            for (Number &entry : row)
              entry = 0.;
        for_each_row([&](const int     row,
                         const Number *factors,
                         const int     begin,
                         const int     end) {
          Number values[dim], slopes[dim];
          for (int i = 0; i < dim; ++i)
            values[i] = slopes[i] = 0.;
          for (int a = begin; a < end; ++a)
            for (int i = 0; i < dim; ++i)
              {
                const double at = u[(row + a) * dim + i];
                values[i] += N[0][a] * at;
                if constexpr (with_gradient)
                  slopes[i] += dN[0][a] * at;
              }
          for (int i = 0; i < dim; ++i)
            {
              field[i] += factors[0] * values[i];
              if constexpr (with_gradient)
                {
                  H[i][0] += factors[0] * slopes[i];
                  for (int j = 1; j < dim; ++j)
                    H[i][j] += factors[j] * values[i];
                }
            }
        });
      }

      /// Compute only the gradient of a field.
      void
      gradient(const double *u, Number (&H)[dim][dim]) const
      {
        Number values[dim];
        evaluate_field<true>(u, values, H);
      }

      /// Compute sums[function * dim + i] += values[i] N.
      void
      add_values(const Number (&values)[dim], Number *sums) const
      {
        for_each_row([&](const int     row,
                         const Number *factors,
                         const int     begin,
                         const int     end) {
          for (int a = begin; a < end; ++a)
            for (int i = 0; i < dim; ++i)
              sums[(row + a) * dim + i] += N[0][a] * (factors[0] * values[i]);
        });
      }

      /// Compute sums[function * dim + i] += T_ij d_j N.
      void
      add_divergence(const Number (&T)[dim][dim], Number *sums) const
      {
        for_each_row([&](const int     row,
                         const Number *factors,
                         const int     begin,
                         const int     end) {
          Number across[dim], along[dim];
          for (int i = 0; i < dim; ++i)
            {
              along[i]  = factors[0] * T[i][0];
              across[i] = factors[1] * T[i][1];
              for (int j = 2; j < dim; ++j)
                across[i] += factors[j] * T[i][j];
            }
          for (int a = begin; a < end; ++a)
            for (int i = 0; i < dim; ++i)
              sums[(row + a) * dim + i] +=
                N[0][a] * across[i] + dN[0][a] * along[i];
        });
      }

      Number N[dim][n_1d];
      Number dN[dim][n_1d];
      int    first[dim], last[dim];
      // The lengths of the box in the cells before and behind, in cell sizes.
      Number before[dim], behind[dim];
      bool   averages_values;

    private:
      /// Add @p weight times the means of polynomials and their derivatives
      /// over [begin, end].
      template <bool with_slopes>
      static inline __attribute__((always_inline)) void
      add_means(const double *polynomials,
                const Number  begin,
                const Number  end,
                const Number  weight,
                const double  inverse_h,
                Number       *values,
                Number       *slopes)
      {
        // The mean of t^k is the sum of begin^i end^(k - i) over k + 1.
        Number means[n], sum = weight, of_begin = weight;
        means[0] = weight;
#pragma GCC unroll 8
        for (int k = 1; k < n; ++k)
          {
            of_begin *= begin;
            sum      = sum * end + of_begin;
            means[k] = sum * (1. / (k + 1));
          }
#pragma GCC unroll 8
        for (int a = 0; a < n; ++a)
          {
            Number value = values[a];
#pragma GCC unroll 8
            for (int k = 0; k < n; ++k)
              value += polynomials[a * n + k] * means[k];
            values[a] = value;
          }
        if constexpr (with_slopes)
          {
#pragma GCC unroll 8
            for (int k = 0; k < n; ++k)
              means[k] *= (k + 1) * inverse_h;
#pragma GCC unroll 8
            for (int a = 0; a < n; ++a)
              {
                Number slope = slopes[a];
#pragma GCC unroll 8
                for (int k = 1; k < n; ++k)
                  slope += polynomials[a * n + k] * means[k - 1];
                slopes[a] = slope;
              }
          }
      }
    };
  } // namespace internal
} // namespace greville

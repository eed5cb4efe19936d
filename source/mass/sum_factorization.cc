// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/base/with_width.h>
#include <greville/mass/sum_factorization.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  ShapeTables<dim>::ShapeTables(const SplineSpace<dim> &space,
                                const unsigned int      n_points_1d)
    : table_size((space.degree() + 1) * n_points_1d)
  {
    const unsigned int  n = space.degree() + 1;
    const QGauss<1>     quadrature(n_points_1d);
    std::vector<double> values(n);
    for (unsigned int d = 0; d < dim; ++d)
      {
        const KnotVector  &knots   = space.knots(d);
        const unsigned int n_cells = knots.n_elements();
        if (d == 0)
          {
            x_stride = n_cells + native_simd_width;
            x.resize(table_size * x_stride, 0.);
          }
        else
          y_and_z[d - 1].resize(std::size_t(n_cells) * table_size);

        for (unsigned int e = 0; e < n_cells; ++e)
          for (unsigned int q = 0; q < n_points_1d; ++q)
            {
              const double lower = knots.element_lower(e);
              const double h     = knots.element_upper(e) - lower;
              knots.evaluate(e,
                             lower + h * quadrature.point(q)(0),
                             0,
                             make_array_view(values));
              for (unsigned int a = 0; a < n; ++a)
                if (d == 0)
                  x[(q * n + a) * x_stride + e] = values[a];
                else
                  y_and_z[d - 1][std::size_t(e) * table_size + q * n + a] =
                    values[a];
            }
      }
  }



  template <int dim>
  void
  ShapeTables<dim>::square()
  {
    for (double &value : x)
      value *= value;
    for (auto &table : y_and_z)
      for (double &value : table)
        value *= value;
  }



  namespace
  {
    /// Multiply one or two columns of a tensor, whose entries lie @p stride
    /// apart, by a matrix or its transpose. Two columns at a time halve the
    /// loads of the matrix and still fit into 16 registers. The second column
    /// is offset by @p next_in and @p next_out.
    template <int  n_functions,
              int  n_points,
              bool transpose,
              int  stride,
              int  n_columns,
              typename Number>
    inline __attribute__((always_inline)) void
    multiply_columns(const Number     *matrix,
                     const NativeSimd *in,
                     const int         next_in,
                     NativeSimd       *out,
                     const int         next_out)
    {
      constexpr int n_in  = transpose ? n_points : n_functions;
      constexpr int n_out = transpose ? n_functions : n_points;

      NativeSimd values[n_columns][n_in];
#pragma GCC unroll 8
      for (int c = 0; c < n_columns; ++c)
#pragma GCC unroll 8
        for (int i = 0; i < n_in; ++i)
          values[c][i] = in[c * next_in + i * stride];
#pragma GCC unroll 8
      for (int j = 0; j < n_out; ++j)
        {
          NativeSimd sums[n_columns];
#pragma GCC unroll 8
          for (int i = 0; i < n_in; ++i)
            {
              const NativeSimd entry =
                matrix[transpose ? i * n_functions + j : j * n_functions + i];
#pragma GCC unroll 8
              for (int c = 0; c < n_columns; ++c)
                sums[c] = i == 0 ? entry * values[c][i]
                                 : sums[c] + entry * values[c][i];
            }
#pragma GCC unroll 8
          for (int c = 0; c < n_columns; ++c)
            out[c * next_out + j * stride] = sums[c];
        }
    }



    /// Compute out(outer, j, inner) = sum_i matrix(j, i) in(outer, i, inner),
    /// or use the transpose of the matrix, which is stored as
    /// [point][function].
    template <int  n_functions,
              int  n_points,
              bool transpose,
              int  n_outer,
              int  n_inner,
              typename Number>
    inline __attribute__((always_inline)) void
    contract(const Number *matrix, const NativeSimd *in, NativeSimd *out)
    {
      constexpr int n_in  = transpose ? n_points : n_functions;
      constexpr int n_out = transpose ? n_functions : n_points;

      // Pairs are neighbours in the inner index or, if it has one value only,
      // in the outer index.
      constexpr int n_pairs  = n_inner == 1 ? n_outer : n_inner;
      constexpr int n_groups = n_inner == 1 ? 1 : n_outer;
      constexpr int next_in  = n_inner == 1 ? n_in : 1;
      constexpr int next_out = n_inner == 1 ? n_out : 1;
      for (int group = 0; group < n_groups; ++group)
        {
          const NativeSimd *from = in + group * n_in * n_inner;
          NativeSimd       *to   = out + group * n_out * n_inner;
          for (int k = 0; k + 1 < n_pairs; k += 2)
            multiply_columns<n_functions, n_points, transpose, n_inner, 2>(
              matrix, from + k * next_in, next_in, to + k * next_out, next_out);
          if constexpr (n_pairs % 2 == 1)
            multiply_columns<n_functions, n_points, transpose, n_inner, 1>(
              matrix,
              from + (n_pairs - 1) * next_in,
              next_in,
              to + (n_pairs - 1) * next_out,
              next_out);
        }
    }



    template <int dim, int n, int q>
    void
    interpolate(const NativeSimd              *in,
                const NativeSimd              *table_x,
                [[maybe_unused]] const double *table_y,
                [[maybe_unused]] const double *table_z,
                NativeSimd                    *out)
    {
      if constexpr (dim == 1)
        contract<n, q, false, 1, 1>(table_x, in, out);
      else if constexpr (dim == 2)
        {
          NativeSimd a[n * q];
          contract<n, q, false, n, 1>(table_x, in, a);
          contract<n, q, false, 1, q>(table_y, a, out);
        }
      else
        {
          NativeSimd a[n * n * q], b[n * q * q];
          contract<n, q, false, n * n, 1>(table_x, in, a);
          contract<n, q, false, n, q>(table_y, a, b);
          contract<n, q, false, 1, q * q>(table_z, b, out);
        }
    }



    template <int dim, int n, int q>
    void
    integrate(const NativeSimd              *in,
              const NativeSimd              *table_x,
              [[maybe_unused]] const double *table_y,
              [[maybe_unused]] const double *table_z,
              NativeSimd                    *out)
    {
      if constexpr (dim == 1)
        contract<n, q, true, 1, 1>(table_x, in, out);
      else if constexpr (dim == 2)
        {
          NativeSimd a[n * q];
          contract<n, q, true, 1, q>(table_y, in, a);
          contract<n, q, true, n, 1>(table_x, a, out);
        }
      else
        {
          NativeSimd a[n * q * q], b[n * n * q];
          contract<n, q, true, 1, q * q>(table_z, in, a);
          contract<n, q, true, n, q>(table_y, a, b);
          contract<n, q, true, n * n, 1>(table_x, b, out);
        }
    }



    /// Apply a ColumnKernel. The numbers of a column stay in registers.
    template <int dim, int n_in, int q, int n_out>
    void
    multiply_column(const NativeSimd *const *in,
                    const double            *table_in,
                    const double            *weights,
                    const double            *table_out,
                    NativeSimd *const       *out)
    {
      constexpr int n_layer = dim == 2 ? q : q * q;
      for (int k = 0; k < n_layer; ++k)
        {
          NativeSimd coefficients[n_in], sums[n_out];
#pragma GCC unroll 8
          for (int i = 0; i < n_in; ++i)
            coefficients[i] = in[i][k];
#pragma GCC unroll 8
          for (int i = 0; i < n_out; ++i)
            sums[i] = out[i][k];
#pragma GCC unroll 8
          for (int j = 0; j < q; ++j)
            {
              NativeSimd value = table_in[j * n_in] * coefficients[0];
#pragma GCC unroll 8
              for (int i = 1; i < n_in; ++i)
                value += table_in[j * n_in + i] * coefficients[i];
              value *= load<NativeSimd>(weights +
                                        (j * n_layer + k) * native_simd_width);
#pragma GCC unroll 8
              for (int i = 0; i < n_out; ++i)
                sums[i] += table_out[j * n_out + i] * value;
            }
#pragma GCC unroll 8
          for (int i = 0; i < n_out; ++i)
            out[i][k] = sums[i];
        }
    }



    template <int dim, int n>
    void
    gather_layer(const unsigned int *numbers,
                 const double       *source,
                 NativeSimd         *values)
    {
      constexpr int n_rows = dim == 2 ? 1 : n;
      for (int row = 0; row < n_rows; ++row)
#pragma GCC unroll 8
        for (int a = 0; a < n; ++a)
          values[row * n + a] = load<NativeSimd>(source + numbers[row * n] + a);
    }



    using Vector = double __attribute__((vector_size(8 * native_simd_width)));

    template <int shift, std::size_t... lanes>
    inline __attribute__((always_inline)) Vector
    shift_lanes(const Vector in, const std::index_sequence<lanes...>)
    {
      constexpr int  width  = native_simd_width;
      constexpr auto source = [](const int lane) {
        return lane >= shift && lane - shift < width ? lane - shift : width;
      };
      return __builtin_shufflevector(in, Vector{}, source(lanes)...);
    }



    /// Return the lanes of @p value shifted up by @p shift (down if negative)
    /// and filled with zeros.
    template <int shift>
    inline __attribute__((always_inline)) NativeSimd
    shift_lanes(const NativeSimd &value)
    {
      Vector in;
      value.copy_to(reinterpret_cast<double *>(&in),
                    std::experimental::vector_aligned);
      const Vector out =
        shift_lanes<shift>(in, std::make_index_sequence<native_simd_width>());
      return NativeSimd(reinterpret_cast<const double *>(&out),
                        std::experimental::vector_aligned);
    }



    /// Function a of lane l is entry l + a of a row. All functions are summed
    /// in registers before they are stored: stores that partly overlap earlier
    /// ones would delay later loads.
    template <int n, int a, int n_vectors>
    inline __attribute__((always_inline)) void
    add_shifted(const NativeSimd *values, NativeSimd (&sums)[n_vectors])
    {
      constexpr int width = native_simd_width;
      constexpr int first = a / width, shift = a % width;
      sums[first] += shift_lanes<shift>(values[a]);
      if constexpr (shift != 0)
        sums[first + 1] += shift_lanes<shift - width>(values[a]);
      if constexpr (a + 1 < n)
        add_shifted<n, a + 1>(values, sums);
    }



    template <int dim, int n>
    void
    scatter_add_layer(const unsigned int *numbers,
                      const NativeSimd   *values,
                      double             *target)
    {
      constexpr int width     = native_simd_width;
      constexpr int n_rows    = dim == 2 ? 1 : n;
      constexpr int n_entries = width + n - 1;
      constexpr int n_vectors = (n_entries + width - 1) / width;
      for (int row = 0; row < n_rows; ++row)
        {
          double    *begin = target + numbers[row * n];
          NativeSimd sums[n_vectors];
#pragma GCC unroll 8
          for (int v = 0; v < n_vectors; ++v)
            sums[v] = 0.;
          add_shifted<n, 0>(values + row * n, sums);

          // The last vector of the row may reach beyond its entries.
          constexpr int n_full = n_entries / width;
#pragma GCC unroll 8
          for (int v = 0; v < n_full; ++v)
            store(load<NativeSimd>(begin + v * width) + sums[v],
                  begin + v * width);
          if constexpr (n_full < n_vectors)
#pragma GCC unroll 8
            for (int lane = 0; lane < n_entries - n_full * width; ++lane)
              begin[n_full * width + lane] += sums[n_full][lane];
        }
    }



    /// Call an action with the number of points per direction as a constant: 2,
    /// ..., 6 for densities and 2 p + 1 for material points.
    template <typename Action>
    void
    with_points(const unsigned int n_points_1d, const Action &action)
    {
      with_one_of<2, 3, 4, 5, 6, 7, 8, 9, 10, 11>(n_points_1d, action);
    }



    /// Return whether the cross mass of spaces with n_1 and n_2 functions per
    /// direction may have q points: p + 1 for densities and 2 p + 1 for
    /// material points, p being the higher order, or 2 p if the orders differ.
    /// Hierarchies decrease the order by one or two, or to order 1.
    constexpr bool
    has_points(const int n_1, const int n_2, const int q)
    {
      const int lower = std::min(n_1, n_2), higher = std::max(n_1, n_2);
      return (q == higher || q == 2 * higher - 1 ||
              (lower < higher && q == 2 * higher - 2)) &&
             (lower + 2 >= higher || lower == 2);
    }

    /// Return whether a space with n functions has a cross mass with q points.
    constexpr bool
    meets_points(const int n, const int q)
    {
      for (int other = 2; other <= 6; ++other)
        if (has_points(n, other, q))
          return true;
      return false;
    }
  } // namespace



  template <int dim>
  CellKernels
  cell_kernels(const unsigned int degree, const unsigned int n_points_1d)
  {
    CellKernels result{};
    with_order(degree, [&](const auto functions) {
      with_points(n_points_1d, [&](const auto points) {
        constexpr int n = decltype(functions)::value;
        constexpr int q = decltype(points)::value;
        if constexpr (n <= q && meets_points(n, q))
          result = {&interpolate<dim, n, q>,
                    &integrate<dim, n, q>,
                    &interpolate<dim - 1, n, q>,
                    &integrate<dim - 1, n, q>,
                    &gather_layer<dim, n>,
                    &scatter_add_layer<dim, n>};
      });
    });
    Require(result.interpolate,
            "No kernel for order " + std::to_string(degree) + " and " +
              std::to_string(n_points_1d) + " points per direction.");
    return result;
  }



  template <int dim>
  ColumnKernel
  column_kernel(const unsigned int degree_in,
                const unsigned int n_points_1d,
                const unsigned int degree_out)
  {
    ColumnKernel result = nullptr;
    with_order(degree_in, [&](const auto functions_in) {
      with_order(degree_out, [&](const auto functions_out) {
        with_points(n_points_1d, [&](const auto points) {
          constexpr int n_in  = decltype(functions_in)::value;
          constexpr int n_out = decltype(functions_out)::value;
          constexpr int q     = decltype(points)::value;
          if constexpr (has_points(n_in, n_out, q))
            result = &multiply_column<dim, n_in, q, n_out>;
        });
      });
    });
    Require(result,
            "No kernel for the mass of the orders " +
              std::to_string(degree_out) + " and " + std::to_string(degree_in) +
              " and " + std::to_string(n_points_1d) + " points per direction.");
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(ShapeTables);
  GREVILLE_INSTANTIATE(cell_kernels);
  GREVILLE_INSTANTIATE(column_kernel);
} // namespace greville

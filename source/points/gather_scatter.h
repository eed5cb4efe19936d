// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "window_shape.h"

/**
 * Sums over the functions that do not vanish on a point's domain (gather), and
 * additions of points to these functions (scatter). To be included in sources.
 *
 * Each function has some vectors of four numbers in a buffer. SIMD acts on
 * these numbers and not on points, since each point has its own functions: in
 * each direction, n + 1 of the n + 2 functions of the window do not vanish on a
 * box that extends over a face, and n functions do not vanish on other boxes.
 */
namespace greville
{
  namespace internal
  {
    /// The distance between two fields of a function in the buffer. In 2D, a
    /// vector of four numbers contains two fields.
    template <int dim>
    constexpr int field_stride = dim == 2 ? 2 : 4;

    template <int dim>
    constexpr int
    n_field_vectors(const int n_fields)
    {
      return (n_fields * field_stride<dim> + 3) / 4;
    }



    /// The sums over all functions a, each of which has vectors u_a: the sums
    /// of N_a u_a for n_vectors vectors; and, unless with_slopes is negative,
    /// the sums of d_d N_a u_a in each direction d for the vector number
    /// with_slopes.
    template <int n_vectors_, int with_slopes_>
    struct Sums
    {
      static constexpr int n_vectors   = n_vectors_;
      static constexpr int with_slopes = with_slopes_;
      static constexpr int n_numbers   = n_vectors * simd_width;

      static constexpr int
      n_all(const int dim)
      {
        return n_vectors + (with_slopes >= 0 ? dim : 0);
      }
    };



    /// The univariate functions of a cell or of its window at a group of
    /// points. In lane l, functions begin[d][l] to end[d][l] do not vanish.
    template <int dim, int n_1d>
    struct LaneShapes
    {
      /// Copy the functions of the cell to the middle of its window.
      void
      read(const ShapeValues<dim, n_1d - 2> &shape)
      {
        constexpr int n = n_1d - 2, first = 1;
        for (int d = 0; d < dim; ++d)
          for (int a = 0; a < n; ++a)
            {
              store(shape.N[d][a], N[d][first + a]);
              store(shape.dN[d][a], dN[d][first + a]);
            }
        std::fill_n(begin[0], dim * simd_width, first);
        std::fill_n(end[0], dim * simd_width, first + n);
      }

      void
      read(const WindowShape<dim, n_1d - 2> &shape)
      {
        for (int d = 0; d < dim; ++d)
          {
            for (int a = 0; a < n_1d; ++a)
              {
                store(shape.N[d][a], N[d][a]);
                store(shape.dN[d][a], dN[d][a]);
              }
            for (unsigned int l = 0; l < simd_width; ++l)
              {
                begin[d][l] = shape.before[d][l] > 0. ? 0 : 1;
                end[d][l]   = shape.behind[d][l] > 0. ? n_1d : n_1d - 1;
              }
          }
      }

      alignas(32) double N[dim][n_1d][simd_width];
      alignas(32) double dN[dim][n_1d][simd_width];
      int begin[dim][simd_width], end[dim][simd_width];
    };



    /// Factors for the functions of a row along x: N_y N_z, followed by its
    /// derivatives by y and z.
    template <int dim>
    struct RowFactors
    {
      double N;
      double dN[dim];
    };



    /// Call action(number of the first function of a row along x, factors) for
    /// all rows of a lane.
    template <int dim, int n_1d, typename Kind, typename Action>
    inline __attribute__((always_inline)) void
    for_each_row(const LaneShapes<dim, n_1d> &shapes,
                 const unsigned int           l,
                 const Kind &,
                 const Action &action)
    {
      const int first_z = dim == 3 ? shapes.begin[dim - 1][l] : 0;
      const int last_z  = dim == 3 ? shapes.end[dim - 1][l] : 1;
      for (int a_z = first_z; a_z < last_z; ++a_z)
        for (int a_y = shapes.begin[1][l]; a_y < shapes.end[1][l]; ++a_y)
          {
            RowFactors<dim> row;
            const double    N_z = dim == 3 ? shapes.N[dim - 1][a_z][l] : 1.;
            const double    N_y = shapes.N[1][a_y][l];
            row.N               = N_y * N_z;
            if constexpr (Kind::with_slopes >= 0)
              {
                row.dN[1] = shapes.dN[1][a_y][l] * N_z;
                if constexpr (dim == 3)
                  row.dN[2] = N_y * shapes.dN[2][a_z][l];
              }
            action((a_z * n_1d + a_y) * n_1d, row);
          }
    }



    /// The nonzero functions of a lane along x.
    template <typename Kind, int n_x>
    struct RowAlongX
    {
      template <int dim, int n_1d>
      RowAlongX(const LaneShapes<dim, n_1d> &shapes, const unsigned int l)
        : begin(shapes.begin[0][l])
      {
        for (int k = 0; k < n_x; ++k)
          {
            N[k] = shapes.N[0][begin + k][l];
            if constexpr (Kind::with_slopes >= 0)
              dN[k] = shapes.dN[0][begin + k][l];
          }
      }

      int  begin;
      Simd N[n_x], dN[n_x];
    };



    /// Call action(number of functions in a row, as a constant).
    template <int dim, int n_1d, typename Action>
    inline __attribute__((always_inline)) void
    with_row_length(const LaneShapes<dim, n_1d> &shapes,
                    const unsigned int           l,
                    const Action                &action)
    {
      const int n_x = shapes.end[0][l] - shapes.begin[0][l];
      if (n_x == n_1d)
        action(std::integral_constant<int, n_1d>());
      else if (n_x == n_1d - 1)
        action(std::integral_constant<int, n_1d - 1>());
      else if constexpr (n_1d > 3)
        action(std::integral_constant<int, n_1d - 2>());
    }



    /// Compute the sums over the functions of one lane with the numbers @p u.
    template <typename Kind, int n_x, int dim, int n_1d>
    inline __attribute__((always_inline)) void
    gather_lane(const LaneShapes<dim, n_1d> &shapes,
                const unsigned int           l,
                const unsigned int          *functions,
                const double                *u,
                Simd                        *sums)
    {
      constexpr int              V = Kind::n_vectors, S = Kind::with_slopes;
      const RowAlongX<Kind, n_x> x(shapes, l);
      for_each_row(
        shapes, l, Kind(), [&](const int row, const RowFactors<dim> &factors) {
          Simd values[V], slope = 0.;
          for (Simd &value : values)
            value = 0.;
#pragma GCC unroll 8
          for (int k = 0; k < n_x; ++k)
            {
              const double *at =
                u + std::size_t(functions[row + x.begin + k]) * Kind::n_numbers;
              for (int v = 0; v < V; ++v)
                {
                  const Simd number = load(at + v * simd_width);
                  values[v] += x.N[k] * number;
                  if (v == S)
                    slope += x.dN[k] * number;
                }
            }
          for (int v = 0; v < V; ++v)
            sums[v] += factors.N * values[v];
          Simd *more = sums + V;
          if constexpr (S >= 0)
            {
              more[0] += factors.N * slope;
              for (int d = 1; d < dim; ++d)
                more[d] += factors.dN[d] * values[S];
            }
        });
    }



    /// Apply the transpose: add to the numbers @p u of the functions of a lane.
    template <typename Kind, int n_x, int dim, int n_1d>
    inline __attribute__((always_inline)) void
    scatter_lane(const LaneShapes<dim, n_1d> &shapes,
                 const unsigned int           l,
                 const unsigned int          *functions,
                 const Simd                  *sums,
                 double                      *u)
    {
      constexpr int              V = Kind::n_vectors, S = Kind::with_slopes;
      const RowAlongX<Kind, n_x> x(shapes, l);
      for_each_row(
        shapes, l, Kind(), [&](const int row, const RowFactors<dim> &factors) {
          Simd values[V], slope = 0.;
          for (int v = 0; v < V; ++v)
            values[v] = factors.N * sums[v];
          const Simd *more = sums + V;
          if constexpr (S >= 0)
            {
              slope = factors.N * more[0];
              for (int d = 1; d < dim; ++d)
                values[S] += factors.dN[d] * more[d];
            }
#pragma GCC unroll 8
          for (int k = 0; k < n_x; ++k)
            {
              double *at =
                u + std::size_t(functions[row + x.begin + k]) * Kind::n_numbers;
              for (int v = 0; v < V; ++v)
                {
                  Simd number = load(at + v * simd_width) + x.N[k] * values[v];
                  if (v == S)
                    number += x.dN[k] * slope;
                  store(number, at + v * simd_width);
                }
            }
        });
    }



    /// Compute the sums of the first @p count points of a group. Number k of
    /// vector v of Sums is in sums[4 v + k]; other lanes are zero.
    template <typename Kind, int dim, int n_1d>
    __attribute__((noinline)) void
    gather(const LaneShapes<dim, n_1d> &shapes,
           const unsigned int           count,
           const unsigned int          *functions,
           const double                *u,
           Simd                        *sums)
    {
      constexpr int      n_all = Kind::n_all(dim);
      alignas(32) double numbers[simd_width][n_all * simd_width];
      for (unsigned int l = 0; l < simd_width; ++l)
        {
          Simd of_lane[n_all];
          for (Simd &sum : of_lane)
            sum = 0.;
          if (l < count)
            with_row_length(shapes, l, [&](const auto n_x) {
              gather_lane<Kind, decltype(n_x)::value>(
                shapes, l, functions, u, of_lane);
            });
          for (int v = 0; v < n_all; ++v)
            store(of_lane[v], numbers[l] + v * simd_width);
        }
      for (unsigned int k = 0; k < n_all * simd_width; ++k)
        sums[k] = Simd([&](const auto l) { return numbers[l][k]; });
    }



    /// Add the first @p count points of a group, with numbers as in gather().
    template <typename Kind, int dim, int n_1d>
    __attribute__((noinline)) void
    scatter(const LaneShapes<dim, n_1d> &shapes,
            const unsigned int           count,
            const unsigned int          *functions,
            const Simd                  *sums,
            double                      *u)
    {
      constexpr int      n_all = Kind::n_all(dim);
      alignas(32) double numbers[n_all * simd_width][simd_width];
      for (unsigned int k = 0; k < n_all * simd_width; ++k)
        store(sums[k], numbers[k]);
      for (unsigned int l = 0; l < count; ++l)
        {
          Simd of_lane[n_all];
          for (int v = 0; v < n_all; ++v)
            of_lane[v] = Simd(
              [&](const auto k) { return numbers[v * simd_width + k][l]; });
          with_row_length(shapes, l, [&](const auto n_x) {
            scatter_lane<Kind, decltype(n_x)::value>(
              shapes, l, functions, of_lane, u);
          });
        }
    }
  } // namespace internal
} // namespace greville

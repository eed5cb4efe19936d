// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/simd.h>
#include <greville/base/with_width.h>
#include <greville/points/point_transfer.h>

#include <cstring>

/// Common parts of the kernels for points. To be included in sources, not in
/// headers.
namespace greville
{
  namespace internal
  {
    /// One number of all points of a group. (Cells have few points, so wider
    /// vectors would have empty lanes.)
    using Simd = FixedSimd<double, MaterialPoints<2>::width>;

    constexpr unsigned int simd_width = Simd::size();

    inline Simd
    load(const double *address)
    {
      return greville::load<Simd>(address);
    }



    constexpr int
    power(const int base, const int exponent)
    {
      return exponent == 0 ? 1 : base * power(base, exponent - 1);
    }



    /// Return the volumes with which points count in PointTransfer::filling().
    template <int dim>
    inline Simd
    filling_volume(const PointLayout<dim> &layout, const double *group)
    {
      constexpr double largest_expansion = 1.5;
      Simd volume = load(group + PointLayout<dim>::volume0 * simd_width);
      if (!layout.is_total_lagrangian())
        volume *=
          min(max(load(group + PointLayout<dim>::J * simd_width), Simd(1.)),
              Simd(largest_expansion));
      return volume;
    }



    /// Data shared by all points of a cell.
    template <int dim, int n>
    struct CellGeometry
    {
      CellGeometry() = default;

      CellGeometry(const SpacePolynomials<dim> &tables, const unsigned int cell)
      {
        const CellBox<dim> box = tables.space->box(cell);
        for (unsigned int d = 0; d < dim; ++d)
          {
            center[d]      = box.center[d];
            inverse_h[d]   = 1. / box.size[d];
            polynomials[d] = tables.directions[d].coefficients(box.index[d]);
            offsets[d] = tables.directions[d].greville_offsets(box.index[d]);
          }
        functions = tables.space->cell_functions(cell).data();
      }

      double              center[dim];
      double              inverse_h[dim];
      const double       *polynomials[dim];
      const double       *offsets[dim];
      const unsigned int *functions;
    };



    /// Values and derivatives of the univariate functions at a group of points,
    /// or at one.
    template <int dim, int n, typename Number = Simd>
    struct ShapeValues
    {
      template <bool derivatives>
      inline __attribute__((always_inline)) void
      evaluate(const CellGeometry<dim, n> &cell, const Number *x)
      {
#pragma GCC unroll 3
        for (int d = 0; d < dim; ++d)
          {
            const Number  t = (x[d] - cell.center[d]) * cell.inverse_h[d];
            const double *c = cell.polynomials[d];
#pragma GCC unroll 6
            for (int a = 0; a < n; ++a)
              {
                Number value = c[a * n + n - 1];
                Number slope = 0.;
#pragma GCC unroll 6
                for (int k = n - 2; k >= 0; --k)
                  {
                    if constexpr (derivatives)
                      slope = slope * t + value;
                    value = value * t + c[a * n + k];
                  }
                N[d][a] = value;
                if constexpr (derivatives)
                  dN[d][a] = slope * cell.inverse_h[d];
              }
          }
      }

      /// Compute the values of all functions of the cell, in lexicographic
      /// order.
      void
      multiply(Number (&values)[power(n, dim)]) const
      {
        for (int a_z = 0, a = 0; a_z < (dim == 3 ? n : 1); ++a_z)
          for (int a_y = 0; a_y < n; ++a_y)
            {
              Number N_yz = N[1][a_y];
              if constexpr (dim == 3)
                N_yz *= N[dim - 1][a_z];
              for (int a_x = 0; a_x < n; ++a_x, ++a)
                values[a] = N_yz * N[0][a_x];
            }
      }

      Number N[dim][n];
      Number dN[dim][n];
    };



    /// Return the number of owned functions and ghosts, the length of buffers.
    template <int dim>
    std::size_t
    n_local_functions(const SplineSpace<dim> &space)
    {
      return space.owned_functions().size() + space.ghost_functions().size();
    }



    /// Copy a vector with its ghost entries into a buffer of @p n_fields
    /// numbers per function.
    template <typename Buffer>
    inline void
    put_into_buffer(const VectorType  &vector,
                    const unsigned int n_fields,
                    const unsigned int field,
                    Buffer            &buffer)
    {
      vector.update_ghost_values();
      const std::size_t n = buffer.size() / n_fields;
      for (std::size_t i = 0; i < n; ++i)
        buffer[i * n_fields + field] = vector.local_element(i);
      vector.zero_out_ghost_values();
    }



    /// Collective. Add up the numbers of each function in the buffers of all
    /// processes.
    template <typename Buffer>
    inline void
    take_from_buffer(const Buffer      &buffer,
                     const unsigned int n_fields,
                     const unsigned int field,
                     VectorType        &vector)
    {
      const std::size_t n = buffer.size() / n_fields;
      vector.zero_out_ghost_values();
      for (std::size_t i = 0; i < n; ++i)
        vector.local_element(i) = buffer[i * n_fields + field];
      vector.compress(dealii::VectorOperation::add);
    }



    /// Load @p count numbers of a group beginning at number @p first.
    template <int count>
    inline __attribute__((always_inline)) void
    load_numbers(const double *group, const int first, Simd *values)
    {
#pragma GCC unroll 9
      for (int k = 0; k < count; ++k)
        values[k] = load(group + (first + k) * simd_width);
    }

    /// Prefetch the numbers [first, last) of the group after number @p g of the
    /// cell number @p c of points.cells(). Kernels read only some numbers of a
    /// group, in a pattern that processors do not predict.
    template <int dim>
    inline __attribute__((always_inline)) void
    prefetch_next(const MaterialPoints<dim> &points,
                  const std::size_t          c,
                  const unsigned int         g,
                  const unsigned int         last,
                  const unsigned int         first = 0)
    {
      const std::vector<unsigned int> &cells = points.cells();
      unsigned int                     next  = points.next_group(g);
      if (next == MaterialPoints<dim>::none && c + 1 < cells.size())
        next = points.first_group(cells[c + 1]);
      if (next == MaterialPoints<dim>::none)
        return;
      const double *group = points.group(next);
      for (std::size_t k = first * simd_width; k < last * simd_width; k += 8)
        __builtin_prefetch(group + k);
    }



    /// Return the sums over the lanes of four vectors, as one vector.
    inline Simd
    reduce_four(const Simd *values)
    {
      static_assert(simd_width == 4, "Four vectors of four lanes.");
      typedef double V __attribute__((vector_size(32)));
      V              v[4];
      // Load one by one: wider loads would wait for the recent stores.
      for (int k = 0; k < 4; ++k)
        std::memcpy(v + k, static_cast<const void *>(values + k), sizeof(V));
      const V first = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6) +
                      __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7),
              second = __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6) +
                       __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7),
              sums = __builtin_shufflevector(first, second, 0, 1, 4, 5) +
                     __builtin_shufflevector(first, second, 2, 3, 6, 7);
      Simd result;
      std::memcpy(static_cast<void *>(&result), &sums, sizeof(result));
      return result;
    }



    /// Load the positions at which the basis functions of a group are
    /// evaluated.
    template <int dim>
    inline __attribute__((always_inline)) void
    load_basis_positions(const MaterialPoints<dim> &points,
                         const double              *group,
                         Simd (&x)[dim])
    {
      load_numbers<dim>(group, points.layout().basis_position, x);
    }



    /// Compute C = A B, or A B^T.
    template <int dim>
    inline void
    multiply(const Simd (&A)[dim][dim],
             const Simd (&B)[dim][dim],
             Simd (&C)[dim][dim])
    {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          {
            C[i][j] = A[i][0] * B[0][j];
            for (int k = 1; k < dim; ++k)
              C[i][j] += A[i][k] * B[k][j];
          }
    }

    template <int dim>
    inline void
    multiply_transposed(const Simd (&A)[dim][dim],
                        const Simd (&B)[dim][dim],
                        Simd (&C)[dim][dim])
    {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          {
            C[i][j] = A[i][0] * B[j][0];
            for (int k = 1; k < dim; ++k)
              C[i][j] += A[i][k] * B[j][k];
          }
    }



    /// Compute the inverse of matrices, and return their determinants.
    template <int dim>
    inline Simd
    invert(const Simd (&A)[dim][dim], Simd (&inverse)[dim][dim])
    {
      // Compute the transposed cofactors.
      if constexpr (dim == 2)
        {
          inverse[0][0] = A[1][1];
          inverse[0][1] = -A[0][1];
          inverse[1][0] = -A[1][0];
          inverse[1][1] = A[0][0];
        }
      else
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            {
              const int a = (i + 1) % 3, b = (i + 2) % 3;
              const int c = (j + 1) % 3, d = (j + 2) % 3;
              inverse[j][i] = A[a][c] * A[b][d] - A[a][d] * A[b][c];
            }
      Simd det = 0.;
      for (int j = 0; j < dim; ++j)
        det += A[0][j] * inverse[j][0];
      const Simd factor = 1. / det;
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          inverse[i][j] *= factor;
      return det;
    }



    /// Compute the inverses of the deformation gradients of a group since the
    /// initial configuration (in 2D their parts in the plane). They map
    /// gradients with respect to reference positions to gradients with respect
    /// to current positions. @p initial_F is the position of the field in
    /// PointLayout.
    template <int dim>
    inline void
    load_inverse_F(const double      *group,
                   const unsigned int initial_F,
                   Simd (&inverse)[dim][dim])
    {
      Simd F[dim][dim];
      for (int i = 0; i < dim; ++i)
        load_numbers<dim>(group, PointLayout<dim>::F + i * dim, F[i]);
      invert<dim>(F, inverse);
      if (initial_F != 0)
        {
          Simd initial[dim][dim], F_inverse[dim][dim];
          std::copy_n(inverse[0], dim * dim, F_inverse[0]);
          for (int i = 0; i < dim; ++i)
            load_numbers<dim>(group, initial_F + i * dim, initial[i]);
          multiply<dim>(initial, F_inverse, inverse);
        }
    }



    template <int count>
    inline __attribute__((always_inline)) void
    store_numbers(const Simd *values, const int first, double *group)
    {
#pragma GCC unroll 9
      for (int k = 0; k < count; ++k)
        store(values[k], group + (first + k) * simd_width);
    }



    /// Call action(order, hoop) like with_order(), with std::true_type as the
    /// second argument for axisymmetric points.
    template <int dim, typename Action>
    void
    with_order_and_hoop(const unsigned int degree,
                        const bool         is_axisymmetric,
                        const Action      &action)
    {
      with_order(degree, [&](const auto order) {
        if constexpr (dim == 2)
          if (is_axisymmetric)
            return action(order, std::true_type());
        action(order, std::false_type());
      });
    }
  } // namespace internal
} // namespace greville

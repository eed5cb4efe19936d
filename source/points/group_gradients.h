// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "point_kernels.h"

/// Evaluation of fields, and sums, of a cell at groups of points. To be
/// included in sources.
namespace greville
{
  namespace internal
  {
    /// The functions of a cell at a group of points, row by row in x, for a
    /// field of @p n_components. Arrays contain the pairs of a component and a
    /// direction, followed by the value of the first component if
    /// @p with_value.
    template <int dim, int n, int n_components, bool with_value>
    struct GroupGradients : ShapeValues<dim, n, Simd>
    {
      static constexpr int n_pairs = n_components * dim + (with_value ? 1 : 0);
      static constexpr int n_numbers = power(n, dim) * n_components;
      // The padded length for reduce_four().
      static constexpr int n_padded = (n_numbers + 3) / 4 * 4;

      /// Call action(number of the row, factors of the row), with a factor for
      /// derivatives in each direction. The factor along x also applies to
      /// values.
      template <typename Action>
      inline __attribute__((always_inline)) void
      for_each_row(const Action &action) const
      {
        const auto &N = this->N, &dN = this->dN;
        // Do not unroll: the code of high orders would not fit into the cache.
#pragma GCC unroll 1
        for (int z = 0; z < (dim == 3 ? n : 1); ++z)
#pragma GCC unroll 6
          for (int y = 0; y < n; ++y)
            {
              Simd factors[dim];
              factors[0] = N[1][y];
              factors[1] = dN[1][y];
              if constexpr (dim == 3)
                {
                  factors[2] = N[1][y] * dN[2][z];
                  factors[0] *= N[2][z];
                  factors[1] *= N[2][z];
                }
              action(z * n + y, factors);
            }
      }

      /// Compute H_ij = d_j u_i, with u[function * n_components + i].
      inline __attribute__((always_inline)) void
      gradient(const double *u, Simd (&H)[n_pairs]) const
      {
        for (Simd &entry : H)
          entry = 0.;
        for_each_row([&](const int row, const Simd *factors) {
          const double *c = u + row * n * n_components;
#pragma GCC unroll 3
          for (int i = 0; i < n_components; ++i)
            {
              Simd value = this->N[0][0] * c[i], slope = this->dN[0][0] * c[i];
#pragma GCC unroll 6
              for (int x = 1; x < n; ++x)
                {
                  value += this->N[0][x] * c[x * n_components + i];
                  slope += this->dN[0][x] * c[x * n_components + i];
                }
              H[i * dim] += factors[0] * slope;
#pragma GCC unroll 3
              for (int j = 1; j < dim; ++j)
                H[i * dim + j] += factors[j] * value;
              if constexpr (with_value)
                if (i == 0)
                  H[n_components * dim] += factors[0] * value;
            }
        });
      }

      /// Compute sums[function * n_components + i] += T_ij d_j N. For i = 0,
      /// the value entry of T times N is added, too.
      inline __attribute__((always_inline)) void
      add_divergence(const Simd (&T)[n_pairs], Simd *sums) const
      {
        for_each_row([&](const int row, const Simd *factors) {
          Simd *to = sums + row * n * n_components;
#pragma GCC unroll 3
          for (int i = 0; i < n_components; ++i)
            {
              const Simd along  = factors[0] * T[i * dim];
              Simd       across = factors[1] * T[i * dim + 1];
              if constexpr (dim == 3)
                across += factors[2] * T[i * dim + 2];
              if constexpr (with_value)
                if (i == 0)
                  across += factors[0] * T[n_components * dim];
#pragma GCC unroll 6
              for (int x = 0; x < n; ++x)
                to[x * n_components + i] +=
                  this->N[0][x] * across + this->dN[0][x] * along;
            }
        });
      }
    };
  } // namespace internal
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/simd.h>

#include <cstddef>
#include <type_traits>

namespace greville
{
  /// The memory of a row of a symmetric matrix of blocks of @p nc x @p nc
  /// numbers, for functions of a lattice with @f$ |i_d - j_d| \le p = n - 1 @f$
  /// in each direction d. It is the half of the stencil with j >= i in
  /// lexicographic order; the block on the diagonal is stored with half of each
  /// entry. Entry (c, d) of the block at x in line number k, counted from the
  /// row's own line, is row[(k * nc + c) * line_size + x * nc + d]. Blocks with
  /// j < i in the own line are zero.
  template <int dim, int nc, int n, typename Number>
  struct HalfStencil
  {
    static constexpr int length = 2 * n - 1;
    static constexpr int n_lines =
      (dim == 3 ? length * length : length) / 2 + 1;

    /// The width of vectors: eight floats, unless this adds many more zeros
    /// than four.
    static constexpr int width     = std::is_same_v<Number, float> &&
                                     (length * nc + 7) / 8 * 8 - length * nc < 4
                                       ? 8
                                       : 4;
    static constexpr int n_vectors = (length * nc + width - 1) / width;
    static constexpr int line_size = n_vectors * width;
    static constexpr int row_size  = n_lines * nc * line_size;

    /// Add the products of a row: y_i += B_ij x_j, y_j += B_ij^T x_i. Line
    /// number k begins p functions before x_i + distances[k].
    static void
    multiply(const Number         *row,
             const Number         *x_i,
             Number               *y_i,
             const std::ptrdiff_t *distances)
    {
      using Vector = FixedSimd<Number, width>;
      Vector own[nc], sums[nc];
      for (int c = 0; c < nc; ++c)
        {
          own[c]  = x_i[c];
          sums[c] = Number(0.);
        }
      for (int k = 0; k < n_lines; ++k)
        {
          const Number *x_k = x_i + distances[k];
          Number       *y_k = y_i + distances[k];
#pragma GCC unroll 10
          for (int v = 0; v < n_vectors; ++v)
            {
              const Vector from = load<Vector>(x_k + v * width);
              Vector       to   = load<Vector>(y_k + v * width);
#pragma GCC unroll 3
              for (int c = 0; c < nc; ++c)
                {
                  const Vector entry =
                    load<Vector>(row + (c * n_vectors + v) * width);
                  sums[c] += entry * from;
                  to += entry * own[c];
                }
              store(to, y_k + v * width);
            }
          row += nc * line_size;
        }
      for (int c = 0; c < nc; ++c)
        y_i[c] += reduce(sums[c]);
    }
  };
} // namespace greville

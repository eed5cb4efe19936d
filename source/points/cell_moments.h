// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "point_kernels.h"
#include <type_traits>

/// Stiffness matrices of cells with many points. To be included in sources.
namespace greville
{
  namespace internal
  {
    /// The matrix of a cell, sum_p C_iJkL(p) d_J N_a(p) d_L N_b(p), from the
    /// moments of C. In a cell, the product of derivatives is a polynomial of
    /// degree 2 (n - 1) in each direction, less one for each derivative in this
    /// direction. For n = 2 in 3D, the moments take 486 products per point, and
    /// a sum over functions 1584. The matrix is then a tensor product.
    template <int dim, int n>
    class CellMoments
    {
    public:
      /// Add groups of points, with C at C[group] + entry(iJ, kL) * simd_width;
      /// symmetric matrices have only their upper half.
      template <typename Entry>
      void
      add(const CellGeometry<dim, n> &geometry,
          const double *const        *positions,
          const double *const        *C,
          const int                   n_groups,
          const Entry                &entry)
      {
        Simd t[most_groups][dim];
        for (int g = 0; g < n_groups; ++g)
          for (int d = 0; d < dim; ++d)
            t[g][d] =
              (load(positions[g] + d * simd_width) - geometry.center[d]) *
              geometry.inverse_h[d];
        for_each_pair([&](const auto J, const auto L) {
          if constexpr (J <= L)
            {
              using Powers = Degrees<J, L>;
              Simd monomials[most_groups][Powers::size];
              for (int g = 0; g < n_groups; ++g)
                Powers::evaluate(t[g], monomials[g]);
              for (int i = 0, block = 0; i < dim; ++i)
                for (int k = i; k < dim; ++k, ++block)
                  {
                    add_entry<Powers::size>(moments[J][L][block],
                                            monomials,
                                            C,
                                            n_groups,
                                            entry(i * dim + J, k * dim + L));
                    if (J < L && i < k)
                      add_entry<Powers::size>(moments[L][J][block],
                                              monomials,
                                              C,
                                              n_groups,
                                              entry(i * dim + L, k * dim + J));
                  }
            }
        });
      }

      void
      clear()
      {
        std::fill_n(&moments[0][0][0][0], sizeof(moments) / sizeof(Simd), 0.);
      }

      /// Write the matrix, block by block of components i <= k.
      template <typename Number>
      void
      write(const CellGeometry<dim, n> &geometry,
            const int                   stride,
            Number                     *matrix)
      {
        sum_lanes();
        set_products(geometry);
        std::fill_n(&planes[0][0][0][0], sizeof(planes) / sizeof(Simd), 0.);
        for_each_pair(
          [&](const auto J, const auto L) { contract_x_and_y<J, L>(); });
        for (int xy = 0; xy < n_1d * n_1d; ++xy)
          for (int z = 0; z < n_z; ++z)
            {
              Simd blocks[n_vectors];
              contract_z(xy, z, blocks);
              const auto number = [&](const auto of_pair) {
                return (of_pair(z) * n + of_pair(xy % n_1d)) * n +
                       of_pair(xy / n_1d);
              };
              const int a = number([](const int ab) { return ab / n; }),
                        b = number([](const int ab) { return ab % n; });
              for (int block = 0; block < n_blocks; ++block)
                matrix[(std::size_t(block) * power(n, dim) + a) * stride + b] =
                  Number(blocks[block / simd_width][block % simd_width]);
            }
      }

      /// The largest number of groups of add().
      static constexpr int most_groups = 8;

    private:
      static constexpr int n_blocks  = dim * (dim + 1) / 2;
      static constexpr int n_vectors = (n_blocks + simd_width - 1) / simd_width;
      static constexpr int n_1d      = n * n; // pairs of functions
      static constexpr int n_z       = dim == 3 ? n_1d : 1;
      static constexpr int n_powers  = 2 * n - 1;

      /// The monomials of d_J N_a d_L N_b.
      template <int J, int L>
      struct Degrees
      {
        static constexpr int
        count(const int d)
        {
          return d < dim ? n_powers - (J == d) - (L == d) : 1;
        }

        static constexpr int x = count(0), y = count(1), z = count(2);
        static constexpr int size = x * y * z;
        /// The kind of products along z: which factors are derivatives.
        static constexpr int kind = dim == 3 ? 2 * (J == 2) + (L == 2) : 0;

        static inline __attribute__((always_inline)) void
        evaluate(const Simd (&t)[dim], Simd (&monomials)[size])
        {
          Simd of_z = 1.;
          for (int c = 0, m = 0; c < z; ++c, of_z *= t[dim - 1])
            {
              Simd of_yz = of_z;
              for (int b = 0; b < y; ++b, of_yz *= t[1])
                {
                  Simd monomial = of_yz;
                  for (int a = 0; a < x; ++a, ++m, monomial *= t[0])
                    monomials[m] = monomial;
                }
            }
        }
      };

      static constexpr int most = dim == 3
                                    ? (n_powers - 1) * (n_powers - 1) * n_powers
                                    : (n_powers - 1) * (n_powers - 1);
      // The largest number of monomials, padded for reduce_four().
      static constexpr int n_padded = (most + 3) / 4 * 4;

      /// Call action(J, L) for all pairs of directions.
      template <typename Action>
      static inline __attribute__((always_inline)) void
      for_each_pair(const Action &action)
      {
        const auto with_second = [&](const auto J) {
          action(J, std::integral_constant<int, 0>());
          action(J, std::integral_constant<int, 1>());
          if constexpr (dim == 3)
            action(J, std::integral_constant<int, 2>());
        };
        with_second(std::integral_constant<int, 0>());
        with_second(std::integral_constant<int, 1>());
        if constexpr (dim == 3)
          with_second(std::integral_constant<int, 2>());
      }

      template <int size>
      static inline __attribute__((always_inline)) void
      add_entry(Simd (&sums)[n_padded],
                const Simd (&monomials)[most_groups][size],
                const double *const *C,
                const int            n_groups,
                const int            entry)
      {
        Simd in_registers[size];
#pragma GCC unroll 12
        for (int m = 0; m < size; ++m)
          in_registers[m] = sums[m];
#pragma GCC unroll 1
        for (int g = 0; g < n_groups; ++g)
          {
            const Simd of_group = load(C[g] + entry * int(simd_width));
#pragma GCC unroll 12
            for (int m = 0; m < size; ++m)
              in_registers[m] += of_group * monomials[g][m];
          }
#pragma GCC unroll 12
        for (int m = 0; m < size; ++m)
          sums[m] = in_registers[m];
      }

      /// Sum over the lanes. The results contain blocks in place of lanes.
      void
      sum_lanes()
      {
        for_each_pair([&](const auto J, const auto L) {
          for (int i = 0, block = 0; i < dim; ++i)
            for (int k = i; k < dim; ++k, ++block)
              {
                // Blocks on the diagonal are symmetric and stored for J <= L
                // only.
                const Simd *from =
                  i == k && J > L ? moments[L][J][block] : moments[J][L][block];
                for (int m = 0; m < Degrees<J, L>::size; m += 4)
                  {
                    double sums[4];
                    store(reduce_four(from + m), sums);
                    for (int e = 0; e < 4; ++e)
                      numbers[J][L][m + e][block] = sums[e];
                  }
              }
        });
      }

      /// Set the coefficients of products of functions and their derivatives.
      void
      set_products(const CellGeometry<dim, n> &geometry)
      {
        for (int d = 0; d < dim; ++d)
          for (int ab = 0; ab < n_1d; ++ab)
            {
              const double *f = geometry.polynomials[d] + ab / n * n,
                           *g = geometry.polynomials[d] + ab % n * n;
              const double h  = geometry.inverse_h[d];
              for (int kind = 0; kind < 4; ++kind)
                std::fill_n(products[d][kind][ab], n_powers, 0.);
              for (int k = 0; k < n; ++k)
                for (int l = 0; l < n; ++l)
                  {
                    const double product = f[k] * g[l];
                    products[d][0][ab][k + l] += product;
                    if (l > 0)
                      products[d][1][ab][k + l - 1] += l * h * product;
                    if (k > 0)
                      products[d][2][ab][k + l - 1] += k * h * product;
                    if (k > 0 && l > 0)
                      products[d][3][ab][k + l - 2] += k * h * l * h * product;
                  }
            }
      }

      template <int J, int L>
      inline __attribute__((always_inline)) void
      contract_x_and_y()
      {
        using Powers         = Degrees<J, L>;
        constexpr int kind_x = 2 * (J == 0) + (L == 0),
                      kind_y = 2 * (J == 1) + (L == 1);
        for (int c = 0; c < Powers::z; ++c)
          for (int x = 0; x < n_1d; ++x)
            {
              Simd of_x[Powers::y][n_vectors];
#pragma GCC unroll 3
              for (int b = 0; b < Powers::y; ++b)
                for (int v = 0; v < n_vectors; ++v)
                  {
                    const auto *from =
                      numbers[J][L] + (c * Powers::y + b) * Powers::x;
                    Simd sum = 0.;
#pragma GCC unroll 3
                    for (int a = 0; a < Powers::x; ++a)
                      sum += products[0][kind_x][x][a] *
                             load(from[a] + v * int(simd_width));
                    of_x[b][v] = sum;
                  }
              for (int y = 0; y < n_1d; ++y)
                for (int v = 0; v < n_vectors; ++v)
                  {
                    Simd sum = planes[Powers::kind][c][x * n_1d + y][v];
#pragma GCC unroll 3
                    for (int b = 0; b < Powers::y; ++b)
                      sum += products[1][kind_y][y][b] * of_x[b][v];
                    planes[Powers::kind][c][x * n_1d + y][v] = sum;
                  }
            }
      }

      inline __attribute__((always_inline)) void
      contract_z(const int xy, const int z, Simd (&blocks)[n_vectors]) const
      {
        for (int v = 0; v < n_vectors; ++v)
          blocks[v] = dim == 3 ? Simd(0.) : planes[0][0][xy][v];
        if constexpr (dim == 3)
          for (int kind = 0; kind < 4; ++kind)
            for (int c = 0; c < n_powers - kind % 2 - kind / 2; ++c)
              for (int v = 0; v < n_vectors; ++v)
                blocks[v] += products[2][kind][z][c] * planes[kind][c][xy][v];
      }

      // [J][L][block][monomial]. [J][L] contains C_iJkL for i <= k; for i == k
      // only J <= L.
      Simd moments[dim][dim][n_blocks][n_padded];
      // [J][L][monomial][block]
      double numbers[dim][dim][n_padded][n_vectors * simd_width] = {};
      // [direction][kind][functions a, b][power]
      double products[dim][4][n_1d][n_powers];
      // [kind along z][power of z][pairs along x, y][blocks]
      Simd planes[dim == 3 ? 4 : 1][dim == 3 ? n_powers : 1][n_1d * n_1d]
                 [n_vectors];
    };
  } // namespace internal
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/lanes.h>

#include <array>

/// Left Cauchy-Green tensors b = F F^T of several points at once, stored as e =
/// b - 1, which keeps small strains at full precision.
namespace greville
{
  /// Return the change of entry ij of b for l_kl = 1: (l b + b l^T)_ij.
  inline __attribute__((always_inline)) Lanes
  change_of_left_cauchy_green(const std::array<Lanes, 6> &b,
                              const unsigned int          entry,
                              const unsigned int          k,
                              const unsigned int          l)
  {
    const unsigned int i = entry_rows[entry], j = entry_columns[entry];
    Lanes              sum = 0.;
    if (i == k)
      sum += b[number_of_entry[l][j]];
    if (j == k)
      sum += b[number_of_entry[l][i]];
    return sum;
  }



  /// Return b - 1 for the left Cauchy-Green tensor b = F F^T: xx, yy, zz, xy,
  /// xz, yz.
  inline __attribute__((always_inline)) std::array<Lanes, 6>
  left_cauchy_green_less_one(const std::array<Lanes, 9> &F)
  {
    // Compute squares less one as (F_ii - 1) (F_ii + 1), without cancellation.
    const Lanes h0 = F[0] - 1., h1 = F[4] - 1., h2 = F[8] - 1.;
    return {{h0 * (F[0] + 1.) + F[1] * F[1] + F[2] * F[2],
             h1 * (F[4] + 1.) + F[3] * F[3] + F[5] * F[5],
             h2 * (F[8] + 1.) + F[6] * F[6] + F[7] * F[7],
             F[0] * F[3] + F[1] * F[4] + F[2] * F[5],
             F[0] * F[6] + F[1] * F[7] + F[2] * F[8],
             F[3] * F[6] + F[4] * F[7] + F[5] * F[8]}};
  }



  /// Return f b f^T - 1 from @p e = b - 1. It is the elastic left Cauchy-Green
  /// tensor less one at the end of a step without plastic flow.
  inline std::array<Lanes, 6>
  push_forward(const std::array<Lanes, 9> &f, const std::array<Lanes, 6> &e)
  {
    // f (1 + e) f^T - 1 = f e f^T + (f f^T - 1).
    std::array<Lanes, 6> result = left_cauchy_green_less_one(f);
    Lanes                m[3][3];
    for (unsigned int i = 0; i < 3; ++i)
      {
        const Lanes *row = &f[3 * i];
        m[i][0]          = row[0] * e[0] + row[1] * e[3] + row[2] * e[4];
        m[i][1]          = row[0] * e[3] + row[1] * e[1] + row[2] * e[5];
        m[i][2]          = row[0] * e[4] + row[1] * e[5] + row[2] * e[2];
      }
    for (unsigned int k = 0; k < 6; ++k)
      {
        const unsigned int i = entry_rows[k], j = 3 * entry_columns[k];
        result[k] += m[i][0] * f[j] + m[i][1] * f[j + 1] + m[i][2] * f[j + 2];
      }
    return result;
  }



  inline Lanes
  determinant(const std::array<Lanes, 9> &F)
  {
    return F[0] * (F[4] * F[8] - F[5] * F[7]) -
           F[1] * (F[3] * F[8] - F[5] * F[6]) +
           F[2] * (F[3] * F[7] - F[4] * F[6]);
  }



  /// For e = b - 1: det(b) - 1, and its part that is nonlinear in e.
  struct SquaredVolume
  {
    explicit SquaredVolume(const std::array<Lanes, 6> &e)
    {
      const Lanes minor = e[1] * e[2] - e[5] * e[5];
      nonlinear = minor + e[0] * (e[1] + e[2]) - e[3] * e[3] - e[4] * e[4] +
                  e[0] * minor + e[3] * (e[4] * e[5] - e[3] * e[2]) +
                  e[4] * (e[3] * e[5] - e[1] * e[4]);
      less_one = e[0] + e[1] + e[2] + nonlinear;
    }

    Lanes nonlinear, less_one;
  };
} // namespace greville

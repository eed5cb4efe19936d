// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/trial_step.h>

#include "group_lanes.h"
#include "point_kernels.h"

/// Stress of a group of points in a trial step and its derivative, from the
/// results of the material. To be included in sources.
namespace greville
{
  namespace internal
  {
    /// A group of points in a trial step. Tensors have entries in the plane in
    /// 2D, followed by the entries zz of axisymmetric points.
    template <int dim>
    struct GroupTrial
    {
      static constexpr int n_pairs = TrialGroup<dim>::n_pairs;

      unsigned int number, count;
      Simd         volume;
      /// f, its inverse, and its determinant including f_zz.
      Simd f[dim][dim], inverse[dim][dim], f_zz = 1., theta;
      /// The radius to which f_zz is relative, 1 in plane strain.
      Simd radius = 1.;
      /// Before the step: the Cauchy stress, and the energy per volume.
      Simd stress_before[dim][dim], stress_before_zz, energy_before;
      /// The change of this energy in the step.
      Simd change_of_energy;
      /// P and its derivative dP_iJ / df_kL = map_Jj A_ijkl map_Ll.
      Simd P[dim][dim], P_zz;
      Simd A[n_pairs][n_pairs], map[dim][dim];
      /// The number of pairs in use.
      int n_used;
    };



    /// Replace A by dP / df: multiply it by the map on both sides, and the pair
    /// zz by @p factor_zz. Symmetric matrices use only their upper half.
    template <int dim>
    inline __attribute__((always_inline)) void
    map_tangent(GroupTrial<dim> &trial,
                const Simd      &factor_zz,
                const Simd      &volume,
                const bool       symmetric)
    {
      auto &A = trial.A;
      Simd  left[dim][dim];
      for (int J = 0; J < dim; ++J)
        for (int j = 0; j < dim; ++j)
          left[J][j] = volume * trial.map[J][j];
#pragma GCC unroll 3
      for (int i = 0; i < dim; ++i)
        {
          const int first = symmetric ? i : 0;
          for (int r = i * dim; r < (i + 1) * dim; ++r)
            for (int k = first; k < dim; ++k)
              {
                Simd *const row = A[r] + k * dim;
                Simd        old[dim];
                std::copy_n(row, dim, old);
#pragma GCC unroll 3
                for (int L = 0; L < dim; ++L)
                  {
                    row[L] = old[0] * trial.map[L][0];
#pragma GCC unroll 2
                    for (int l = 1; l < dim; ++l)
                      row[L] += old[l] * trial.map[L][l];
                  }
              }
          for (int s = first * dim; s < dim * dim; ++s)
            {
              Simd old[dim];
#pragma GCC unroll 3
              for (int j = 0; j < dim; ++j)
                old[j] = A[i * dim + j][s];
#pragma GCC unroll 3
              for (int J = 0; J < dim; ++J)
                {
                  Simd sum = left[J][0] * old[0];
#pragma GCC unroll 2
                  for (int j = 1; j < dim; ++j)
                    sum += left[J][j] * old[j];
                  A[i * dim + J][s] = sum;
                }
            }
        }
      if constexpr (dim == 2)
        if (trial.n_used > dim * dim)
          {
            Simd by[dim * dim], of[dim * dim];
            for (int i = 0; i < dim; ++i)
              for (int J = 0; J < dim; ++J)
                {
                  const int r = i * dim + J;
                  by[r]       = factor_zz * (left[J][0] * A[i * dim][4] +
                                       left[J][1] * A[i * dim + 1][4]);
                  of[r]       = factor_zz * (left[J][0] * A[4][i * dim] +
                                       left[J][1] * A[4][i * dim + 1]);
                }
            for (int r = 0; r < dim * dim; ++r)
              {
                A[r][4] = by[r];
                A[4][r] = of[r];
              }
            A[4][4] *= factor_zz * factor_zz * volume;
          }
    }



    /// Set P and A at the end of a step from the material's results.
    template <int dim>
    inline __attribute__((always_inline)) void
    set_end_stress(GroupTrial<dim>            &trial,
                   const std::array<Lanes, 6> &stress,
                   const TangentLanes         *D,
                   const bool                  symmetric)
    {
      Simd tau[dim][dim];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          tau[i][j] = trial.theta * stress[number_of_entry[i][j]];
      multiply_transposed<dim>(tau, trial.inverse, trial.P);
      trial.P_zz = trial.theta * stress[2] / trial.f_zz;
      std::copy_n(trial.inverse[0], dim * dim, trial.map[0]);
      if (!D)
        return;
#pragma GCC unroll 3
      for (int i = 0; i < dim; ++i)
#pragma GCC unroll 3
        for (int j = 0; j < dim; ++j)
          {
            const auto &row = (*D)[number_of_entry[i][j]];
            for (int k = symmetric ? i : 0; k < dim; ++k)
              for (int l = 0; l < dim; ++l)
                {
                  Simd entry = trial.theta * row[3 * k + l];
                  if (k == l)
                    entry += tau[i][j];
                  if (j == k)
                    entry -= tau[i][l];
                  trial.A[i * dim + j][k * dim + l] = entry;
                }
          }
      if constexpr (dim == 2)
        if (trial.n_used > dim * dim)
          {
            const Simd factor = trial.theta / trial.f_zz;
            for (int i = 0; i < dim; ++i)
              for (int j = 0; j < dim; ++j)
                {
                  const int  r = i * dim + j, e = number_of_entry[i][j];
                  const Simd diagonal = i == j ? stress[2] : Simd(0.);
                  trial.A[4][r] = factor * ((*D)[2][3 * i + j] + diagonal);
                  trial.A[r][4] = factor * ((*D)[e][8] + stress[e]);
                }
            trial.A[4][4] = factor / trial.f_zz * (*D)[2][8];
          }
    }



    /// Replace P at the end of the step, and its derivative, by the
    /// energy-consistent stress and its derivative, see TrialStep.
    template <int dim>
    inline void
    make_energy_consistent(GroupTrial<dim> &trial, const bool with_tangent)
    {
      Simd middle[dim][dim], end[dim][dim], strain[dim][dim], S[dim][dim];
      multiply<dim>(trial.inverse, trial.P, end);
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          {
            const double one = i == j ? 1. : 0.;
            middle[i][j]     = 0.5 * (one + trial.f[i][j]);
            Simd sum         = trial.f[i][j] + trial.f[j][i] - 2. * one;
            for (int k = 0; k < dim; ++k)
              sum += (trial.f[k][i] - (k == i ? 1. : 0.)) *
                     (trial.f[k][j] - (k == j ? 1. : 0.));
            strain[i][j] = 0.5 * sum;
            S[i][j]      = 0.5 * (trial.stress_before[i][j] + end[i][j]);
          }
      // The zz entries of an axisymmetric point.
      const Simd f_zz      = trial.f_zz;
      const Simd strain_zz = 0.5 * (f_zz * f_zz - 1.);
      const Simd end_zz = trial.P_zz / f_zz, middle_zz = 0.5 * (1. + f_zz);
      Simd       S_zz   = 0.5 * (trial.stress_before_zz + end_zz);
      Simd       square = strain_zz * strain_zz, work = S_zz * strain_zz;
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          {
            square += strain[i][j] * strain[i][j];
            work += S[i][j] * strain[i][j];
          }
      // The correction is of the order of the strain squared, but its round-off
      // is the round-off of the energy over the strain. It is omitted for
      // smaller strains.
      constexpr double smallest = 6e-6; // the third root of round-off
      const auto       is_large = square > smallest * smallest;
      const Simd       factor =
        choose(is_large,
               (trial.change_of_energy - work) / choose(is_large, square, 1.),
               0.);
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          S[i][j] += factor * strain[i][j];
      S_zz += factor * strain_zz;
      if (with_tangent)
        {
          // dP = df S / 2 + middle dS, dS = f^-1 (dP_end - df S_end) / 2.
          map_tangent(trial, 1., 1., false);
          Simd map[dim][dim];
          multiply<dim>(middle, trial.inverse, map);
          for (int J = 0; J < dim; ++J)
            for (int s = 0; s < trial.n_used; ++s)
              {
                Simd old[dim];
                for (int m = 0; m < dim; ++m)
                  old[m] = trial.A[m * dim + J][s];
                const int k = s / dim, L = s % dim;
                for (int i = 0; i < dim; ++i)
                  {
                    Simd sum = 0.;
                    for (int m = 0; m < dim; ++m)
                      sum += map[i][m] * old[m];
                    if (s < dim * dim)
                      sum +=
                        (i == k ? S[L][J] : Simd(0.)) - map[i][k] * end[L][J];
                    trial.A[i * dim + J][s] = 0.5 * sum;
                  }
              }
          if constexpr (dim == 2)
            {
              const Simd map_zz = 0.5 * middle_zz / f_zz;
              for (int s = 0; s < dim * dim; ++s)
                trial.A[4][s] *= map_zz;
              trial.A[4][4] = 0.5 * S_zz + map_zz * (trial.A[4][4] - end_zz);
            }
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              trial.map[i][j] = i == j ? 1. : 0.;
        }
      multiply<dim>(middle, S, trial.P);
      trial.P_zz = middle_zz * S_zz;
    }
  } // namespace internal
} // namespace greville

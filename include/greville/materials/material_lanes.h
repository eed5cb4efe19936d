// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_material_lanes_h
#define greville_materials_material_lanes_h

#include <greville/materials/lanes.h>
#include <greville/materials/material.h>

namespace greville
{
  /**
   * What energies need of several points at once; see MaterialPoint for the
   * numbers. Lanes without a point are stress-free.
   */
  struct MaterialLanes
  {
    MaterialLanes() = default;

    /**
     * Of one point, in the first lane.
     */
    explicit MaterialLanes(const MaterialPoint &point)
      : count(1)
      , n_state(History<double>::n_first + point.state.more.size())
    {
      for (unsigned int i = 0; i < 9; ++i)
        F[i] = i % 4 == 0 ? 1. : 0.;
      for (unsigned int i = 0; i < 9; ++i)
        F[i][0] = point.F[i / 3][i % 3];
      J    = 1.;
      J[0] = point.J;
      for (unsigned int i = 0; i < 6; ++i)
        {
          stress[i]    = 0.;
          stress[i][0] = point.stress.access_raw_entry(i);
        }
      state.resize(n_state);
      for (unsigned int k = 0; k < n_state; ++k)
        {
          state[k]    = 0.;
          state[k][0] = point.state[k];
        }
    }

    unsigned int count = n_lanes, n_state = 0;
    /// Row by row.
    std::array<Lanes, 9> F;
    Lanes                J;
    /// xx, yy, zz, xy, xz, yz.
    std::array<Lanes, 6> stress;
    /// The first n_state of them.
    History<Lanes> state;
  };



  /**
   * Energies per volume of the stress-free state, J / m^3.
   */
  struct EnergyLanes
  {
    Lanes strain = 0., dissipation = 0.;
  };



  /**
   * b - 1 for the left Cauchy-Green tensor b = F F^T: xx, yy, zz, xy, xz, yz.
   */
  inline std::array<Lanes, 6>
  left_cauchy_green_less_one(const std::array<Lanes, 9> &F)
  {
    // Squares less one as (F_ii - 1) (F_ii + 1), without cancellation.
    const Lanes h0 = F[0] - 1., h1 = F[4] - 1., h2 = F[8] - 1.;
    return {{h0 * (F[0] + 1.) + F[1] * F[1] + F[2] * F[2],
             h1 * (F[4] + 1.) + F[3] * F[3] + F[5] * F[5],
             h2 * (F[8] + 1.) + F[6] * F[6] + F[7] * F[7],
             F[0] * F[3] + F[1] * F[4] + F[2] * F[5],
             F[0] * F[6] + F[1] * F[7] + F[2] * F[8],
             F[3] * F[6] + F[4] * F[7] + F[5] * F[8]}};
  }



  /**
   * For e = b - 1: det(b) - 1 and the part of it that is not linear in e.
   */
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



  /**
   * x - ln(1 + x) to round-off, relative to the result, of small x too.
   */
  inline Lanes
  less_log_of_one_plus(const Lanes &x)
  {
    // ln(1 + x) = 2 atanh(z)
    const Lanes z = x / (2. + x), z2 = z * z;
    Lanes       sum = 0.;
#pragma GCC unroll 9
    for (int k = 19; k > 1; k -= 2)
      sum = sum * z2 + 1. / k;
    const Lanes near     = z * (x - 2. * z2 * sum);
    const auto  is_small = abs(x) < 0.3;
    if (all_of(is_small))
      return near;
    return choose(is_small, near, x - log_of_one_plus(x));
  }



  /**
   * exp(x) - 1 - x to round-off, relative to the result, of small x too.
   */
  inline Lanes
  exp_less_one_less(const Lanes &x)
  {
    Lanes sum = 1.;
#pragma GCC unroll 12
    for (int k = 14; k > 2; --k)
      sum = 1. + sum * x * (1. / k);
    const Lanes near     = 0.5 * x * x * sum;
    const auto  is_small = abs(x) < 0.3;
    if (all_of(is_small))
      return near;
    return choose(is_small, near, exp_less_one(x) - x);
  }
} // namespace greville

#endif

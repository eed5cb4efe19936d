// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/simd.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  /// One number for each of several points, in one SIMD register if the machine
  /// has registers of this width.
  using Lanes = FixedSimd<double, 4>;

  constexpr unsigned int n_lanes = Lanes::size();

  /// Rows and columns of the entries xx, yy, zz, xy, xz, yz.
  constexpr unsigned int entry_rows[]    = {0, 1, 2, 0, 0, 1};
  constexpr unsigned int entry_columns[] = {0, 1, 2, 1, 2, 2};

  /// The number of each entry of a symmetric tensor in this order.
  constexpr unsigned int number_of_entry[3][3] = {{0, 3, 4},
                                                  {3, 1, 5},
                                                  {4, 5, 2}};



  // Return, lane by lane, a where the condition is true and b elsewhere. With
  // these functions, algorithms work on a double or on Lanes.
  inline double
  choose(const bool condition, const double a, const double b)
  {
    return condition ? a : b;
  }

  inline __attribute__((always_inline)) Lanes
  choose(const Lanes::mask_type &condition, const Lanes &a, const Lanes &b)
  {
    Lanes result             = b;
    where(condition, result) = a;
    return result;
  }

  inline bool
  is_true_everywhere(const bool condition)
  {
    return condition;
  }

  inline bool
  is_true_everywhere(const Lanes::mask_type &condition)
  {
    return all_of(condition);
  }

  inline double
  smaller_of(const double a, const double b)
  {
    return std::min(a, b);
  }

  inline __attribute__((always_inline)) Lanes
  smaller_of(const Lanes &a, const Lanes &b)
  {
    return min(a, b);
  }

  inline double
  larger_of(const double a, const double b)
  {
    return std::max(a, b);
  }

  inline __attribute__((always_inline)) Lanes
  larger_of(const Lanes &a, const Lanes &b)
  {
    return max(a, b);
  }



  /// Return ln(1 + x), with a relative error of round-off also for small x.
  inline double
  log_of_one_plus(const double x)
  {
    return std::log1p(x);
  }

  /**
   * With z = x / (2 + x), use the power series of ln(1 + x) = 2 atanh(z) for
   * |x| < 0.4. For -0.75 < x < 3, also use ln(1 + x) = 4 ln(1 + y) with 1 + y =
   * (1 + x)^(1/4).
   */
  inline Lanes
  log_of_one_plus(Lanes x)
  {
    double factor = 2.;
    if (!all_of(abs(x) < 0.4))
      {
        if (!all_of(x > -0.75 && x < 3.))
          {
            for (unsigned int lane = 0; lane < n_lanes; ++lane)
              x[lane] = std::log1p(double(x[lane]));
            return x;
          }
        for (unsigned int i = 0; i < 2; ++i)
          x = x / (1. + sqrt(1. + x));
        factor = 8.;
      }
    // Even and odd powers of z^2 are independent sums, which run in parallel.
    const Lanes z = x / (2. + x), z2 = z * z, z4 = z2 * z2;
    Lanes       even = 1. / 21., odd = 1. / 23.;
#pragma GCC unroll 5
    for (int k = 17; k > 0; k -= 4)
      {
        even = even * z4 + 1. / k;
        odd  = odd * z4 + 1. / (k + 2);
      }
    return factor * z * (even + z2 * odd);
  }



  /// Return exp(x) - 1, with a relative error of round-off also for small x.
  inline double
  exp_less_one(const double x)
  {
    return std::expm1(x);
  }

  /// Use the power series for |x| < 0.4. For |x| < 1.6, also square twice:
  /// exp(2 x) - 1 = (exp(x) - 1) (exp(x) + 1).
  inline Lanes
  exp_less_one(Lanes x)
  {
    const bool is_small = all_of(abs(x) < 0.4);
    if (!is_small)
      {
        if (!all_of(abs(x) < 1.6))
          {
            for (unsigned int lane = 0; lane < n_lanes; ++lane)
              x[lane] = std::expm1(double(x[lane]));
            return x;
          }
        x *= 0.25;
      }
    Lanes sum = 1.;
#pragma GCC unroll 14
    for (int k = 14; k > 1; --k)
      sum = sum * x * (1. / k) + 1.;
    sum *= x;
    if (!is_small)
      for (unsigned int i = 0; i < 2; ++i)
        sum *= 2. + sum;
    return sum;
  }



  /// Return x - ln(1 + x), with a relative error of round-off also for small x.
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



  /// Return exp(x) - 1 - x, with a relative error of round-off also for small
  /// x.
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

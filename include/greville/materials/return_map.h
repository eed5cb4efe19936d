// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky.h>

/// Functions shared by returns to a yield surface in principal stresses.
namespace greville
{
  /// Derivatives d tau_a / d tau_b(trial) of returned stresses, and (tau_a -
  /// tau_b) / (tau_a(trial) - tau_b(trial)) for (a, b) = (0, 1), (0, 2), (1,
  /// 2).
  struct ReturnTangent
  {
    double slopes[3][3];
    double ratios[3];
  };



  /// Return (tau_1 + tau_2 + tau_3) / 3.
  inline double
  mean_of(const Principal &tau)
  {
    return (tau[0] + tau[1] + tau[2]) / 3.;
  }



  /// Return J2 = dev(tau) : dev(tau) / 2.
  inline double
  second_invariant(const Principal &tau)
  {
    const double a = tau[0] - tau[1], b = tau[1] - tau[2], c = tau[2] - tau[0];
    return (a * a + b * b + c * c) / 6.;
  }



  inline void
  scale_deviator(Principal &tau, const double factor, const double mean)
  {
    const double shift = mean - factor * mean_of(tau);
    for (double &t : tau)
      t = factor * t + shift;
  }



  /// Compute the tangent of a return that scales the deviator. The given
  /// derivatives are derivatives of the new radius sqrt(J2) and mean stress by
  /// q = sqrt(J2) and p of the trial stress.
  inline void
  set_tangent(ReturnTangent   &tangent,
              const Principal &trial,
              const double     radius,
              const double     radius_by_q,
              const double     radius_by_p,
              const double     mean_by_q,
              const double     mean_by_p)
  {
    const double q = std::sqrt(second_invariant(trial)), p = mean_of(trial);
    const double inverse = q > 0. ? 1. / q : 0.;
    const double factor  = q > 0. ? radius * inverse : radius_by_q;
    // dq / d tau_a = n_a / 2, n = s / q
    for (unsigned int b = 0; b < 3; ++b)
      {
        const double n    = (trial[b] - p) * inverse;
        const double mean = 0.5 * mean_by_q * n + mean_by_p / 3.;
        const double scaling =
          0.5 * (radius_by_q - factor) * n + radius_by_p / 3.;
        for (unsigned int a = 0; a < 3; ++a)
          tangent.slopes[a][b] = (a == b ? factor : 0.) - factor / 3. +
                                 scaling * (trial[a] - p) * inverse + mean;
        tangent.ratios[b] = factor;
      }
  }
} // namespace greville

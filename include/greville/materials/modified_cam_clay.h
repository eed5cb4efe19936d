// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/critical_state.h>

namespace greville
{
  /**
   * Modified Cam-Clay (@ref Roscoe1968 "Roscoe and Burland, 1968") for finite
   * strains (@ref Borja1998 "Borja and Tamagnini, 1998"), in the Kirchhoff
   * stress: with the pressure P = p + a above the apex (compression is
   * positive, see PressureElasticity) and q = sqrt(3 J2),
   *   f = q^2 / M^2 + P (P - C) <= 0,
   *   d eps_p = dgamma df / dtau,
   *   d ln C = -d eps_v^p / (lambda - kappa),
   * where eps_v^p is the logarithmic plastic volumetric strain. On the normal
   * compression line, P = C and ln V = -lambda ln P + const. The critical state
   * is q = M P, P = C / 2. With the void ratio e_1 of normal compression to P_1
   * = 1 kPa, all states satisfy
   *   ln(1 + e) = ln(1 + e_1) - kappa ln(P / P_1)
   *               - (lambda - kappa) ln(C / P_1).
   * An initial stress (P, q) has C = R (P + q^2 / (M^2 P)) for the
   * overconsolidation ratio R.
   *
   * The unknown of the return is t = q / (M P). It gives
   *   P = C / (1 + t^2),
   *   d = kappa (lambda - kappa) / lambda ln(P(trial) / C_n (1 + t^2)),
   *   C = C_n exp(d / (lambda - kappa)),
   * where d is the plastic compaction; t solves
   *   (1 - t^2) (q - q(trial)) + 6 G / M t d = 0.
   * A root lies between t = 1, the critical state, and the t at which the
   * surface at the beginning of the step has the elastic pressure, for any
   * step. P is positive in between, so no stress is beyond the apex.
   *
   * State: see CriticalStateLaw; the size of the yield surface is C, the
   * "preconsolidation".
   *
   * Parameters: the parameters of CriticalStateLaw, "Compression slope" lambda,
   * and "Void ratio" e_1. reinit() throws dealii::ExcMessage unless lambda >
   * kappa.
   */
  class ModifiedCamClay : public CriticalStateLaw<ModifiedCamClay>
  {
  public:
    static constexpr const char *name      = "modified-cam-clay";
    static constexpr const char *size_name = "preconsolidation";

    ModifiedCamClay()
    {
      ratio = 1.;
    }

    static std::vector<std::string>
    more_names()
    {
      return {};
    }

    void
    declare(dealii::ParameterHandler &prm) override
    {
      CriticalStateLaw<ModifiedCamClay>::declare(prm);
      add_parameter(prm, "Compression slope", lambda, positive())(
        "Decrease of the logarithm of the volume with that of the pressure in "
        "normal compression: lambda / (1 + e), more than the swelling slope. "
        "Unit: none.");
      add_parameter(prm, "Void ratio", void_ratio_at_reference, positive())(
        "Void ratio after normal compression to 1 kPa. Unit: none.");
    }

    void
    reinit(const std::string &section) override
    {
      CriticalStateLaw<ModifiedCamClay>::reinit(section);
      check_parameter(lambda > elastic.kappa,
                      section,
                      "Compression slope",
                      lambda,
                      "greater than the swelling slope, which is " +
                        text_of(elastic.kappa));
      plastic_slope = lambda - elastic.kappa;
    }

    void
    set_initial(State &state, const double log_pressure, const double q) const
    {
      const double P = elastic.attraction * std::exp(log_pressure);
      state[size]    = overconsolidation * (P + q * q / (ratio * ratio * P));
      set_void_ratio(state, log_pressure);
    }

    bool
    return_map(const CriticalStateStep &trial,
               State                   &state,
               CriticalStateReturn     &result,
               const bool               differentiate) const
    {
      const double a = elastic.attraction, C_n = state[size];
      // ln(P / C_n) of the trial state, limited to the range of exp().
      const double L = std::max(trial.log_pressure + std::log(a / C_n), -600.);
      const double P_trial = C_n * std::exp(L);
      if (square(trial.q / ratio) <= -P_trial * C_n * std::expm1(L))
        {
          set_void_ratio(state, trial.log_pressure);
          return false;
        }

      const Equation equation{*this, C_n, L, trial.q};
      const double   t    = equation.solve();
      const Point    p    = equation.at(t);
      result.q            = p.q;
      result.log_pressure = std::log(p.P / a);
      state[size]         = p.C;
      set_void_ratio(state, result.log_pressure);
      if (differentiate)
        {
          // The derivatives of h, ln P and q by t, L and q(trial).
          const double chi = equation.chi(), kappa = elastic.kappa;
          const double P_by_t = -p.d_by_t / kappa, P_by_L = 1. - chi / kappa;
          const double q_by_t = ratio * p.P + p.q * P_by_t,
                       q_by_L = p.q * P_by_L;
          const double h_by_L =
            (1. - t * t) * q_by_L + equation.stiffness() * t * chi;
          const double t_by_L       = -h_by_L / p.h_by_t,
                       t_by_q       = (1. - t * t) / p.h_by_t;
          result.pressure_by_volume = -(P_by_L + P_by_t * t_by_L) / kappa;
          result.pressure_by_q      = P_by_t * t_by_q;
          result.q_by_volume        = -(q_by_L + q_by_t * t_by_L) / kappa;
          result.q_by_q             = q_by_t * t_by_q;
        }
      return true;
    }

  private:
    static double
    square(const double x)
    {
      return x * x;
    }

    /// The state for a value of the unknown t, the residual h, and the
    /// derivatives of d and h by t.
    struct Point
    {
      double P, C, q, d_by_t, h, h_by_t;
    };

    struct Equation
    {
      const ModifiedCamClay &law;
      const double           C_n, L, q_trial;

      double
      chi() const
      {
        return law.elastic.kappa * law.plastic_slope / law.lambda;
      }

      double
      stiffness() const
      {
        return 6. * law.elastic.shear / law.ratio;
      }

      Point
      at(const double t) const
      {
        Point        p;
        const double d = chi() * (L + std::log1p(t * t));
        p.C            = C_n * std::exp(d / law.plastic_slope);
        p.P            = p.C / (1. + t * t);
        p.q            = law.ratio * t * p.P;
        p.d_by_t       = chi() * 2. * t / (1. + t * t);
        p.h            = (1. - t * t) * (p.q - q_trial) + stiffness() * t * d;
        p.h_by_t       = -2. * t * (p.q - q_trial) +
                   (1. - t * t) *
                     (law.ratio * p.P - p.q * p.d_by_t / law.elastic.kappa) +
                   stiffness() * (d + t * p.d_by_t);
        return p;
      }

      /// Solve by Newton's method, with bisection (of logarithms) if a step
      /// leaves the interval.
      double
      solve() const
      {
        const double elastic_t = L < 0. ? std::sqrt(std::expm1(-L)) : 0.;
        double       lower     = std::min(elastic_t, 1.), // h <= 0
          upper                = std::max(elastic_t, 1.); // h >= 0
        double t = elastic_t < 1. ? 0.5 * (lower + upper) : elastic_t;
        for (unsigned int i = 0; i < 300; ++i)
          {
            const Point p              = at(t);
            (p.h > 0. ? upper : lower) = t;
            double next                = t - p.h / p.h_by_t;
            if (!(next >= lower && next <= upper))
              next = upper > 4. * lower && lower > 0. ? std::sqrt(lower * upper)
                                                      : 0.5 * (lower + upper);
            // The round-off error of the terms of h.
            const double round_off =
              4e-16 *
              (std::abs(1. - t * t) * (p.q + q_trial) +
               stiffness() * t * chi() * (std::abs(L) + std::log1p(t * t)));
            const bool is_found =
              std::abs(next - t) <= 2e-16 * t || std::abs(p.h) <= round_off;
            t = next;
            if (is_found)
              break;
          }
        return t;
      }
    };

    void
    set_void_ratio(State &state, const double log_pressure) const
    {
      state[void_ratio] =
        (1. + void_ratio_at_reference) *
          std::exp(-elastic.kappa * log_of_reference(log_pressure) -
                   plastic_slope * std::log(state[size] / reference_pressure)) -
        1.;
    }

    double lambda                  = 0.1;
    double void_ratio_at_reference = 1.5;
    double plastic_slope           = 0.;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/critical_state.h>

namespace greville
{
  /**
   * NorSand (@ref Jefferies1993 "Jefferies, 1993"; @ref Jefferies2016
   * "Jefferies and Been, 2016") for finite strains (@ref Borja2006 "Borja and
   * Andrade, 2006"), in the Kirchhoff stress, with M independent of Lode's
   * angle: with the pressure P = p + a above the apex (compression is positive,
   * see PressureElasticity), q = sqrt(3 J2) and eta = q / P,
   *   f = eta - M (1 - ln(P / P_i)) <= 0,
   *   d eps_v^p = (M - eta) dm, d eps_q^p = dm,
   *   dP_i = H (P_max - P_i) dm, P_max = P exp(-chi psi_i / M),
   *   psi_i = e - e_c(P_i), e_c(P) = Gamma - lambda ln(P / 1 kPa),
   * where P_i is the image pressure, at which eta = M on the surface, and e the
   * void ratio, with 1 + e proportional to the volume. Dense sand, psi < 0,
   * reaches the largest dilatancy chi psi_i; its surface grows beyond the
   * critical state and shrinks back to it. The surface of loose sand shrinks to
   * the critical state. At the tip of the surface, P = e P_i with q = 0, the
   * flow has any direction between the normals of the two sides, and d eps_v^p
   * = M dm.
   *
   * An initial stress (P, q) has the given state parameter psi = e - e_c(P).
   * Its P_i is the image pressure of the surface through the stress, times the
   * overconsolidation ratio R.
   *
   * The return is implicit. Its unknown m gives q = max(q(trial) - 3 G m, 0)
   * and the pressure
   *   ln P = ln P(trial) - M m / kappa + w, w + ln(w) =
   *          ln(m q / (kappa P(trial))) + M m / kappa,
   * (w = m eta / kappa) and solves, with P_i from f = 0,
   *   P_i (1 + H m) = P_i(n) + H m P_max.
   * The left side is larger for m = 0 and the right side for large m, so there
   * is a root for any step.
   *
   * State: see CriticalStateLaw; the size of the yield surface is P_i, the
   * "image_pressure"; the further variable is the "state_parameter" psi.
   *
   * Parameters: the parameters of CriticalStateLaw, "Critical void ratio"
   * Gamma, "Critical slope" lambda, "State parameter" psi, "Dilatancy factor"
   * chi, and "Hardening" H.
   */
  class NorSand : public CriticalStateLaw<NorSand>
  {
  public:
    static constexpr const char *name      = "nor-sand";
    static constexpr const char *size_name = "image_pressure";

    static std::vector<std::string>
    more_names()
    {
      return {"state_parameter"};
    }

    void
    declare(dealii::ParameterHandler &prm) override
    {
      CriticalStateLaw<NorSand>::declare(prm);
      add_parameter(prm, "Critical void ratio", gamma, positive())(
        "Void ratio of the critical state at 1 kPa. Unit: none.");
      add_parameter(prm, "Critical slope", lambda, positive())(
        "Decrease of the critical void ratio with the logarithm of the "
        "pressure. Unit: none.");
      add_parameter(prm, "State parameter", psi)(
        "Initial state parameter: void ratio less critical void ratio at the "
        "same pressure; negative if dense. Unit: none.");
      add_parameter(prm, "Dilatancy factor", chi, dealii::Patterns::Double(0.))(
        "The largest dilatancy over minus the state parameter. Unit: none.");
      add_parameter(prm, "Hardening", hardening, positive())(
        "Rate of the image pressure per plastic shear strain, over its "
        "distance from its limit. Unit: none.");
    }

    void
    set_initial(State &state, const double log_pressure, const double q) const
    {
      const double P = elastic.attraction * std::exp(log_pressure);
      state[size]    = overconsolidation * P * std::exp(q / (P * ratio) - 1.);
      state[void_ratio] = critical_void_ratio(log_pressure) + psi;
      state[more]       = psi;
    }

    bool
    return_map(const CriticalStateStep &trial,
               State                   &state,
               CriticalStateReturn     &result,
               const bool               differentiate) const
    {
      const double a = elastic.attraction, kappa = elastic.kappa;
      state[void_ratio] = (1. + state[void_ratio]) * trial.volume - 1.;
      Equation     equation{*this,
                        trial.log_pressure,
                        trial.q,
                        state[void_ratio],
                        std::log(state[size] / a)};
      const double f =
        trial.log_pressure - 1. - equation.log_size_before +
        (trial.q > 0. ? trial.q / (ratio * a) * std::exp(-trial.log_pressure)
                      : 0.);
      if (f <= 0.)
        {
          state[more] =
            state[void_ratio] - critical_void_ratio(trial.log_pressure);
          return false;
        }
      const double m      = equation.solve();
      const Point  p      = equation.at(m);
      result.log_pressure = p.y;
      result.q            = p.q;
      state[size]         = a * std::exp(p.log_size);
      state[more]         = state[void_ratio] - critical_void_ratio(p.y);
      if (differentiate)
        {
          // Derivatives by eps_v, which changes ln P(trial) and e, and by
          // q(trial).
          const double r_by_volume = -p.r.by_x / kappa +
                                     (1. + state[void_ratio]) * p.r.by_e,
                       m_by_volume = -r_by_volume / p.r.by_m,
                       m_by_q      = -p.r.by_q / p.r.by_m;
          result.pressure_by_volume =
            -p.dy.by_x / kappa + p.dy.by_m * m_by_volume;
          result.pressure_by_q = p.dy.by_q + p.dy.by_m * m_by_q;
          const double q_by_m  = p.q > 0. ? -3. * elastic.shear : 0.;
          result.q_by_volume   = q_by_m * m_by_volume;
          result.q_by_q        = (p.q > 0. ? 1. : 0.) + q_by_m * m_by_q;
        }
      return true;
    }

  private:
    /// Derivatives with respect to m, ln P(trial), q(trial) and e.
    struct Slopes
    {
      double by_m = 0., by_x = 0., by_q = 0., by_e = 0.;

      friend Slopes
      operator+(const Slopes &a, const Slopes &b)
      {
        return {a.by_m + b.by_m,
                a.by_x + b.by_x,
                a.by_q + b.by_q,
                a.by_e + b.by_e};
      }

      friend Slopes
      operator*(const double f, const Slopes &a)
      {
        return {f * a.by_m, f * a.by_x, f * a.by_q, f * a.by_e};
      }
    };

    /// The state for one m: y = ln(P / a), q, ln(P_i / a), and the logarithm of
    /// the ratio of both sides of the equation, with their derivatives.
    struct Point
    {
      double y, q, log_size, residual;
      Slopes dy, r;
    };

    struct Equation
    {
      const NorSand &law;
      const double   x, q_trial, e, log_size_before;

      Point
      at(const double m) const
      {
        const double a = law.elastic.attraction, kappa = law.elastic.kappa,
                     G = law.elastic.shear, M = law.ratio, H = law.hardening;
        Point p;
        p.q              = std::max(q_trial - 3. * G * m, 0.);
        const double dry = x - M * m / kappa;
        double       w = 0., eta = 0.;
        Slopes       d_eta;
        p.y  = dry;
        p.dy = {-M / kappa, 1., 0., 0.};
        if (p.q > 0. && m > 0.)
          {
            w   = solve_product(std::log(m * p.q / (kappa * a)) - dry);
            p.y = dry + w;
            eta = w * kappa / m;
            // Derivatives of w + ln(w) and of eta = q exp(-y) / a.
            const Slopes dq_by_q{-3. * G / p.q, 0., 1. / p.q, 0.};
            const Slopes dz = Slopes{1. / m, 0., 0., 0.} + dq_by_q + -1. * p.dy;
            p.dy            = p.dy + (w / (1. + w)) * dz;
            d_eta           = eta * (dq_by_q + -1. * p.dy);
          }
        else if (p.q > 0.)
          eta = p.q / a * std::exp(-x);
        p.log_size              = p.y + eta / M - 1.;
        const Slopes d_size     = p.dy + (1. / M) * d_eta;
        const double psi_i      = e - law.critical_void_ratio(p.log_size);
        const Slopes d_psi      = Slopes{0., 0., 0., 1.} + law.lambda * d_size;
        const double exponent   = p.y - law.chi * psi_i / M;
        const Slopes d_exponent = p.dy + (-law.chi / M) * d_psi;
        const double before     = std::exp(log_size_before),
                     gain       = H * m * std::exp(std::min(exponent, 600.));
        p.residual = p.log_size + std::log1p(H * m) - std::log(before + gain);
        const double share = gain / (before + gain);
        p.r                = d_size + Slopes{H / (1. + H * m), 0., 0., 0.} +
              -share * (d_exponent + Slopes{m > 0. ? 1. / m : 0., 0., 0., 0.});
        return p;
      }

      /// Solve by Newton's method, with bisection (of logarithms) if a step
      /// leaves the interval.
      double
      solve() const
      {
        double lower = 0., upper = law.elastic.kappa / law.ratio;
        while (upper < 1e100 && !(at(upper).residual < 0.))
          upper *= 2.;
        double m = 0.5 * (lower + upper);
        for (unsigned int i = 0; i < 300; ++i)
          {
            const Point p                     = at(m);
            (p.residual < 0. ? upper : lower) = m;
            double next                       = m - p.residual / p.r.by_m;
            if (!(next >= lower && next <= upper && next > 0.))
              next = lower > 0. && upper < 4. * lower ? 0.5 * (lower + upper)
                     : lower > 0.                     ? std::sqrt(lower * upper)
                                                      : 0.1 * upper;
            // The residual is a sum of logarithms.
            const bool is_found =
              std::abs(next - m) <= 2e-16 * m ||
              std::abs(p.residual) <= 4e-16 * (1. + std::abs(p.log_size));
            m = next;
            if (is_found)
              break;
          }
        return m;
      }

      /// Return w with w + ln(w) = z, by Newton's method from below.
      static double
      solve_product(const double z)
      {
        if (z < -40.)
          return std::exp(z); // to round-off
        double w = 1. / (1. + std::exp(-z));
        for (unsigned int i = 0; i < 100; ++i)
          {
            const double next = w * (1. + z - std::log(w)) / (1. + w);
            if (!(next > w))
              break;
            w = next;
          }
        return w;
      }
    };

    double
    critical_void_ratio(const double log_pressure) const
    {
      return gamma - lambda * log_of_reference(log_pressure);
    }

    double gamma     = 0.9;
    double lambda    = 0.03;
    double psi       = 0.;
    double chi       = 3.5;
    double hardening = 100.;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky_plasticity.h>
#include <greville/materials/strength_reduction.h>

namespace greville
{
  /**
   * Mohr-Coulomb plasticity with softening, non-associated (de Souza Neto,
   * Peric, Owen, section 8.2), in the principal Kirchhoff stresses tau_1 >=
   * tau_2 >= tau_3 (positive in tension, Pa):
   *   f = tau_1 - tau_3 + (tau_1 + tau_3) sin(phi) - 2 c cos(phi) <= 0,
   *   g = tau_1 - tau_3 + (tau_1 + tau_3) sin(psi).
   * The return leads to one of these regions: the plane; the right edge, where
   * also f(tau_1, tau_2) = 0 and tau_2 = tau_3; the left edge, where also
   * f(tau_2, tau_3) = 0 and tau_1 = tau_2; the apex tau = c cot(phi) 1. Each
   * return has a closed form (section 8.2.2 of the book). On an edge or the
   * apex, the flow is the sum over the planes (Koiter).
   *
   * Cohesion c and friction angle phi fall over the accumulated equivalent
   * plastic strain alpha (of the deviator, see HenckyPlasticity) from the peak
   * to the residual value, x = alpha / "Softening strain":
   *   linear:      c = c_r + (c_p - c_r) max(1 - x, 0),
   *   exponential: c = c_r + (c_p - c_r) exp(-x),
   * and phi in the same way. alpha at the end of the step solves alpha =
   * alpha_n + d alpha(alpha), by a bracketed secant method: the plastic strain
   * of a return is at most the deviatoric trial strain. The returned stress is
   * on the surface of the new alpha up to round-off. If the material softens
   * faster than it unloads elastically, there are several solutions, and one of
   * them is used. Results then depend on the grid, as with any local softening.
   *
   * Parameters: "Cohesion", "Residual cohesion", Pa, "Friction angle",
   * "Residual friction angle", "Dilatancy angle", degrees, "Softening",
   * "Softening strain", "Strength reduction", see StrengthReduction. State: see
   * HenckyPlasticity.
   *
   * reinit() throws dealii::ExcMessage for residual > peak values, for psi >
   * the residual phi, for phi = c = 0, and for an invalid Poisson's ratio;
   * initialize() throws for a stress outside the yield surface.
   */
  class MohrCoulomb : public HenckyPlasticity<MohrCoulomb>
  {
  public:
    static constexpr const char *name = "mohr-coulomb";
    static constexpr const char *yield_condition =
      "tau_1 - tau_3 + (tau_1 + tau_3) sin(phi) - 2 c cos(phi)";
    static constexpr bool opens = true;

    void
    declare(dealii::ParameterHandler &prm) override;

    bool
    spreads() const override
    {
      return true;
    }

    /// Return true for associated flow without softening; see DruckerPrager for
    /// materials that bear tension.
    bool
    has_symmetric_tangent() const override
    {
      return !softens && dilatancy_angle == friction_angle && peak.apex <= 0. &&
             (friction_angle == 0. ||
              !reduction_of_strength.changes_strength());
    }

    void
    reinit(const std::string &section) override;

    double
    strength_reduction(const double time) const override
    {
      return reduction_of_strength.at(time);
    }

    double
    yield_function(const Principal &tau,
                   const double     alpha,
                   const double     reduction) const
    {
      const Surface s = surface_at(alpha, reduction);
      return s.f(std::max(tau[0], std::max(tau[1], tau[2])),
                 std::min(tau[0], std::min(tau[1], tau[2])));
    }

    /// Return the mean stress of the apex, infinite without friction. A
    /// strength reduction does not move the apex.
    double
    largest_mean_stress(const double alpha) const
    {
      return surface_at(alpha, 1.).apex;
    }

    bool
    return_map(Principal     &tau,
               double        &alpha,
               double        &opening,
               const double   reduction,
               ReturnTangent *tangent = nullptr) const
    {
      // Sort the stresses.
      unsigned int i = 0, j = 1, k = 2;
      if (tau[i] < tau[j])
        std::swap(i, j);
      if (tau[j] < tau[k])
        std::swap(j, k);
      if (tau[i] < tau[j])
        std::swap(i, j);
      const Principal trial{{tau[i], tau[j], tau[k]}};
      const Surface   start = surface_at(alpha, reduction);
      if (start.f(trial[0], trial[2]) <= 0.)
        return false;

      Principal    result = returned(trial, start);
      const double growth = equivalent_strain(trial, result);
      if (softens && growth > 0.)
        result = soften(trial, growth, reduction, alpha);
      else
        alpha += growth;
      if (tangent != nullptr)
        differentiate(
          *tangent, trial, result, alpha, reduction, growth > 0., {{i, j, k}});
      if (result[0] == result[2] && start.sine > 0.)
        opening += opening_at_apex(trial, result[0], start.sin_dilatancy);
      tau[i] = result[0];
      tau[j] = result[1];
      tau[k] = result[2];
      return true;
    }

  private:
    /// The coefficients of a yield surface: sin(phi), 2 c cos(phi), c cot(phi);
    /// and sin(psi).
    struct Surface
    {
      double sine, strength, apex, sin_dilatancy;

      double
      f(const double larger, const double smaller) const
      {
        return larger - smaller + (larger + smaller) * sine - strength;
      }
    };

    /// The part of the yield surface to which a stress returns.
    enum class Region
    {
      plane,
      right,
      left,
      apex
    };

    Surface
    surface_at(const double alpha, const double reduction) const
    {
      if ((!softens || alpha == 0.) && reduction == 1.)
        return peak;
      return make_surface(alpha, reduction);
    }

    Surface
    make_surface(const double alpha, const double reduction) const;

    /// Return sorted stresses to a given surface.
    Principal
    returned(const Principal &t,
             const Surface   &s,
             Region          *region = nullptr) const
    {
      const double K = elastic.bulk, G = elastic.shear;
      const double phi = s.sine, psi = s.sin_dilatancy;

      // The changes of a plane's largest and smallest stress, and of its
      // intermediate stress, by the flow of this plane.
      const double upper  = 2. * G * (1. + psi / 3.) + 2. * K * psi,
                   lower  = 2. * G * (1. - psi / 3.) - 2. * K * psi,
                   middle = (4. / 3. * G - 2. * K) * psi;
      const double a      = 4. * G * (1. + phi * psi / 3.) + 4. * K * phi * psi;
      const double f      = s.f(t[0], t[2]);

      Principal    r;
      const double gamma = f / a;
      r = {{t[0] - upper * gamma, t[1] + middle * gamma, t[2] + lower * gamma}};
      if (region != nullptr)
        *region = Region::plane;
      if (r[0] >= r[1] && r[1] >= r[2])
        return r;

      const bool right = (1. - psi) * t[0] - 2. * t[1] + (1. + psi) * t[2] > 0.;
      const double f2  = right ? s.f(t[0], t[1]) : s.f(t[1], t[2]);
      const double sign = right ? 1. : -1.;
      const double b    = 2. * G * (1. + sign * (phi + psi) - phi * psi / 3.) +
                       4. * K * phi * psi;
      const double determinant = (a - b) * (a + b);
      const double g1          = (a * f - b * f2) / determinant,
                   g2          = (a * f2 - b * f) / determinant;
      if (right)
        {
          r[0] = t[0] - upper * (g1 + g2);
          r[1] = t[1] + middle * g1 + lower * g2;
          r[2] = t[2] + lower * g1 + middle * g2;
          r[1] = r[2] = 0.5 * (r[1] + r[2]);
        }
      else
        {
          r[0] = t[0] - upper * g1 + middle * g2;
          r[1] = t[1] + middle * g1 - upper * g2;
          r[2] = t[2] + lower * (g1 + g2);
          r[0] = r[1] = 0.5 * (r[0] + r[1]);
        }
      if (region != nullptr)
        *region = right ? Region::right : Region::left;
      if (phi == 0. || !(r[0] < r[2])) // or not a number
        return r;
      if (region != nullptr)
        *region = Region::apex;
      return {{s.apex, s.apex, s.apex}};
    }

    /// Return the plastic volumetric strain of a return from sorted stresses to
    /// the apex, less the dilatancy of its deviator e. At the right edge,
    /// planes with the flows (1 + m, 0, m - 1) gamma, m = sin(psi), meet. Their
    /// volumetric strain is 2 m sum(gamma) with sum(gamma) = e_1 / (1 + m / 3);
    /// at the left edge, sum(gamma) = -e_3 / (1 - m / 3).
    double
    opening_at_apex(const Principal &trial,
                    const double     apex,
                    const double     m) const;

    /// Solve h(x) = alpha + d alpha(x) - x = 0, beginning with the @p growth d
    /// alpha for the old strength. Set @p alpha to x and return the stress.
    Principal
    soften(const Principal &trial,
           const double     growth,
           const double     reduction,
           double          &alpha) const;

    /// Return the derivatives of a surface by alpha.
    Surface
    slope_of_surface(const double alpha, const double reduction) const;

    /// Compute the tangent of a return of sorted stresses to the surface at
    /// @p alpha. @p order contains their original numbers. @p grows says
    /// whether alpha has grown in this return.
    void
    differentiate(ReturnTangent                     &tangent,
                  const Principal                   &trial,
                  const Principal                   &result,
                  const double                       alpha,
                  const double                       reduction,
                  const bool                         grows,
                  const std::array<unsigned int, 3> &order) const;

    /// Compute the derivatives of the result of returned() with respect to the
    /// trial stresses @p t, and with respect to a parameter of the surface
    /// @p s. @p slope contains the derivatives of the surface by this
    /// parameter.
    void
    differentiate_return(const Principal &t,
                         const Surface   &s,
                         const Surface   &slope,
                         double (&by_trial)[3][3],
                         Principal &by_parameter) const;

    double cohesion                = 1e3;
    double residual_cohesion       = -1.;
    double friction_angle          = 30.;
    double residual_friction_angle = -1.;
    double dilatancy_angle         = 0.;
    bool   exponential             = false; // softening
    double softening_strain        = 0.1;

    StrengthReduction reduction_of_strength;

    double  last_cohesion = 0., last_angle = 0.;
    bool    softens = false;
    Surface peak{0., 0., 0., 0.};
  };
} // namespace greville

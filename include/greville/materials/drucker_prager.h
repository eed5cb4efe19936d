// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky_plasticity.h>
#include <greville/materials/strength_reduction.h>

#include <limits>

namespace greville
{
  /**
   * Non-associated plasticity with the cone of @ref Drucker1952 "Drucker and
   * Prager" (@ref Neto2008 "de Souza Neto", section 8.3), without hardening,
   * with a tension cut-off, in the Kirchhoff stress tau with mean p (positive
   * in tension) and deviator s:
   *   f1 = sqrt(J2) + eta p - xi c <= 0, g1 = sqrt(J2) + eta' p,
   *   f2 = p - p_t <= 0,                 g2 = f2,
   * J2 = s : s / 2. The parameter "Cone" selects how the cone fits
   * Mohr-Coulomb's surface of friction angle phi: for plastic flow in plane
   * strain, at the outer or at the inner edges,
   *   plane strain: eta = sin(phi) / n, xi = cos(phi) / n,
   *                 n = sqrt(1 - eta'^2 / 3) + eta' sin(phi) / 3,
   *   plane strain associated: eta = 3 tan(phi) / sqrt(9 + 12 tan(phi)^2),
   *                            xi = 3 / sqrt(9 + 12 tan(phi)^2),
   *   outer: eta = 6 sin(phi) / (sqrt(3) (3 - sin(phi))),
   *          xi = 6 cos(phi) / (sqrt(3) (3 - sin(phi))),
   *   inner: the same with 3 + sin(phi).
   * eta' is the eta of the associated cone (the second formula, outer or inner)
   * with the dilatancy angle psi in place of phi. Flow without strain along z
   * has s_zz = -2 / 3 eta' sqrt(J2), which gives n: "plane strain" has the
   * strength of Mohr-Coulomb for any psi. "plane strain associated" has this
   * strength only if psi = phi and is weaker for smaller psi (@ref Bui2008 "Bui
   * et al." and others use it with psi = 0). The return has a closed form: to
   * the cone,
   *   dgamma = f1(trial) / (G + K eta eta'), p = p(trial) - K eta' dgamma,
   *   sqrt(J2) = sqrt(J2)(trial) - G dgamma;
   * to the cut-off, p = p_t with s = s(trial); or to their intersection, p =
   * p_t and sqrt(J2) = xi c - eta p_t. Without a cut-off, p_t is the apex xi c
   * / eta. Plastic flow on the cone has the volumetric strain eta' dgamma and
   * the equivalent strain dgamma / sqrt(3). State: see HenckyPlasticity.
   *
   * Parameters: "Cohesion" c, Pa, "Friction angle" phi and "Dilatancy angle"
   * psi, degrees, "Tension cut-off" p_t, Pa, "Cone" and "Strength reduction",
   * see StrengthReduction.
   *
   * reinit() throws dealii::ExcMessage for psi > phi, for phi = c = 0, for a
   * cut-off beyond the apex, and for an invalid Poisson's ratio; initialize()
   * throws for a stress outside of the yield surface.
   */
  class DruckerPrager : public HenckyPlasticity<DruckerPrager>
  {
  public:
    static constexpr const char *name = "drucker-prager";
    static constexpr const char *yield_condition =
      "max(sqrt(J2) + eta p - xi c, p - p_t)";
    static constexpr bool opens = true;

    void
    declare(dealii::ParameterHandler &prm) override
    {
      HenckyPlasticity<DruckerPrager>::declare(prm);
      using dealii::Patterns::Double;
      add_parameter(prm, "Friction angle", friction_angle, Double(0., 89.))(
        "Angle of internal friction. Unit: degrees.");
      add_parameter(prm, "Dilatancy angle", dilatancy_angle, Double(0., 89.))(
        "Angle of dilatancy, at most the friction angle. Unit: degrees.");
      add_parameter(prm, "Cohesion", cohesion, Double(0.))(
        "Cohesion, Kirchhoff stress. Unit: Pa.");
      add_parameter(prm, "Tension cut-off", tension_cut_off, Double())(
        "Largest mean stress, Kirchhoff stress; negative: the apex of the "
        "cone. Unit: Pa.");
      add_choice<Cone>(prm,
                       "Cone",
                       cone,
                       {{Cone::plane_strain, "plane strain"},
                        {Cone::plane_strain_associated,
                         "plane strain associated"},
                        {Cone::outer, "outer"},
                        {Cone::inner, "inner"}})(
        "Match of the cone with the surface of Mohr-Coulomb.");
      reduction_of_strength.declare(prm);
    }

    bool
    spreads() const override
    {
      return true;
    }

    void
    reinit(const std::string &section) override
    {
      HenckyPlasticity<DruckerPrager>::reinit(section);
      check_parameter(dilatancy_angle <= friction_angle,
                      section,
                      "Dilatancy angle",
                      dilatancy_angle,
                      "at most the friction angle, which is " +
                        text_of(friction_angle));
      check_parameter(cohesion > 0. || friction_angle > 0.,
                      section,
                      "Cohesion",
                      cohesion,
                      "greater than 0 if the friction angle is 0");
      reduction_of_strength.reinit(section);
      initial           = make_surface(1.);
      const double apex = friction_angle > 0.
                            ? initial.strength / initial.friction
                            : std::numeric_limits<double>::infinity();
      check_parameter(tension_cut_off <= apex * (1. + 1e-12),
                      section,
                      "Tension cut-off",
                      tension_cut_off,
                      "at most the apex of the cone, which is at " +
                        text_of(apex));
      largest_mean =
        tension_cut_off < 0. ? apex : std::min(tension_cut_off, apex);
      is_cut_off            = largest_mean < apex;
      initial.corner_radius = corner_radius_of(initial);
    }

    double
    strength_reduction(const double time) const override
    {
      return reduction_of_strength.at(time);
    }

    /// An opening that closes without stress removes its volumetric strain from
    /// the trial state. The flow rule has no counterpart, so the tangent is not
    /// symmetric.
    bool
    has_symmetric_tangent() const override
    {
      const Surface &s = initial;
      return s.friction == 0. ||
             (std::abs(s.friction - s.dilatancy) <= 1e-12 * s.friction &&
              largest_mean <= 0. && !reduction_of_strength.changes_strength());
    }

    double
    yield_function(const Principal &tau,
                   const double,
                   const double reduction) const
    {
      const double  p = mean_of(tau);
      const Surface s = surface_at(reduction);
      return std::max(std::sqrt(second_invariant(tau)) + s.friction * p -
                        s.strength,
                      p - largest_mean);
    }

    double
    largest_mean_stress(const double) const
    {
      return largest_mean;
    }

    bool
    return_map(Principal     &tau,
               double        &alpha,
               double        &opening,
               const double   reduction,
               ReturnTangent *tangent = nullptr) const
    {
      const double p = mean_of(tau), q = std::sqrt(second_invariant(tau));
      const auto [friction, dilatancy, strength, corner_radius] =
        surface_at(reduction);
      const double f = q + friction * p - strength;
      if (f <= 0. && p <= largest_mean)
        return false;

      // The radius sqrt(J2) and the mean stress of the returned stress.
      double radius = q, mean = largest_mean;
      if (q > corner_radius)
        {
          const double K = elastic.bulk, G = elastic.shear;
          const double sum   = G + K * friction * dilatancy;
          const double gamma = f / sum;
          radius             = q - G * gamma;
          mean               = p - K * dilatancy * gamma;
          if (tangent != nullptr && mean <= largest_mean)
            set_tangent(*tangent,
                        tau,
                        radius,
                        1. - G / sum,
                        -G * friction / sum,
                        -K * dilatancy / sum,
                        1. - K * dilatancy * friction / sum);
          if (mean > largest_mean)
            {
              if (tangent != nullptr)
                set_tangent(*tangent, tau, corner_radius, 0., 0., 0., 0.);
              radius = corner_radius;
              mean   = largest_mean;
              opening +=
                std::max((p - mean) / K - dilatancy * (q - radius) / G, 0.);
            }
          // The equivalent strain |dev(d eps_p)| sqrt(2 / 3).
          alpha += (q - radius) / (std::sqrt(3.) * G);
        }
      else
        {
          opening += (p - mean) / elastic.bulk;
          // At the apex, q is 0.
          if (tangent != nullptr)
            set_tangent(
              *tangent, tau, q, corner_radius > 0. ? 1. : 0., 0., 0., 0.);
        }
      scale_deviator(tau, q > 0. ? radius / q : 1., mean);
      return true;
    }

  private:
    /// The coefficients eta, eta', xi c, and the radius of the cone at p_t.
    struct Surface
    {
      double friction, dilatancy, strength, corner_radius;
    };

    Surface
    surface_at(const double reduction) const
    {
      if (reduction == 1.)
        return initial;
      Surface s       = make_surface(reduction);
      s.corner_radius = corner_radius_of(s);
      return s;
    }

    double
    corner_radius_of(const Surface &s) const
    {
      return is_cut_off ? s.strength - s.friction * largest_mean : 0.;
    }

    /// Return the coefficients of the surface without the radius.
    Surface
    make_surface(const double reduction) const
    {
      const double phi =
        StrengthReduction::reduced_angle(friction_angle, reduction);
      const double psi =
        std::min(StrengthReduction::reduced_angle(dilatancy_angle, 1.), phi);
      const double          dilatancy = associated_cone(psi)[0];
      std::array<double, 2> factors   = associated_cone(phi);
      if (cone == Cone::plane_strain)
        {
          const double n = std::sqrt(1. - dilatancy * dilatancy / 3.) +
                           dilatancy * std::sin(phi) / 3.;
          factors = {{std::sin(phi) / n, std::cos(phi) / n}};
        }
      return {factors[0], dilatancy, factors[1] * cohesion / reduction, 0.};
    }

    /// Return eta and xi of the fitted cone with associated flow.
    std::array<double, 2>
    associated_cone(const double angle) const
    {
      const double tangent = std::tan(angle);
      double       xi;
      if (cone == Cone::plane_strain || cone == Cone::plane_strain_associated)
        xi = 3. / std::sqrt(9. + 12. * tangent * tangent);
      else
        xi = 6. * std::cos(angle) /
             (std::sqrt(3.) *
              (3. + (cone == Cone::outer ? -1. : 1.) * std::sin(angle)));
      return {{xi * tangent, xi}};
    }

    enum class Cone
    {
      plane_strain,
      plane_strain_associated,
      outer,
      inner
    };

    double friction_angle  = 30.;
    double dilatancy_angle = 0.;
    double cohesion        = 0.;
    double tension_cut_off = -1.;
    Cone   cone            = Cone::plane_strain;

    StrengthReduction reduction_of_strength;

    Surface initial{0., 0., 0., 0.}; // without reduction
    double  largest_mean = 0.;       // p_t
    bool    is_cut_off   = false;
  };
} // namespace greville

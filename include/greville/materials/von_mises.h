// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky_plasticity.h>

namespace greville
{
  /**
   * Von Mises plasticity with linear isotropic hardening (de Souza Neto, Peric,
   * Owen, section 7.3), in the Kirchhoff stress tau with deviator s:
   *   f = sqrt(3 J2) - (sigma_y + H alpha) <= 0, J2 = s : s / 2,
   *   d eps_p = dgamma df / dtau, d alpha = dgamma.
   * Radial return: dgamma = f(trial) / (3 G + H), s = (1 - 3 G dgamma / sqrt(3
   * J2(trial))) s(trial). Parameters: sigma_y ("Yield stress", Pa) and H
   * ("Hardening modulus", Pa). State: see HenckyPlasticity.
   *
   * reinit() throws dealii::ExcMessage for an invalid Poisson's ratio,
   * initialize() for a stress outside the yield surface.
   */
  class VonMises : public HenckyPlasticity<VonMises>
  {
  public:
    static constexpr const char *name            = "von-mises";
    static constexpr const char *yield_condition = "sqrt(3 J2) - sigma_y";
    static constexpr bool        opens           = false;

    void
    declare(dealii::ParameterHandler &prm) override
    {
      HenckyPlasticity<VonMises>::declare(prm);
      add_parameter(prm, "Yield stress", yield_stress, positive())(
        "Yield stress in uniaxial tension, Kirchhoff stress. Unit: Pa.");
      using dealii::Patterns::Double;
      add_parameter(prm, "Hardening modulus", hardening_modulus, Double(0.))(
        "Growth of the yield stress per equivalent plastic strain. Unit: Pa.");
    }

    bool
    has_symmetric_tangent() const override
    {
      return true;
    }

    double
    yield_function(const Principal &tau, const double alpha, const double) const
    {
      return std::sqrt(3. * second_invariant(tau)) -
             (yield_stress + hardening_modulus * alpha);
    }

    bool
    return_map(Principal &tau,
               double    &alpha,
               double &,
               const double,
               ReturnTangent *tangent = nullptr) const
    {
      const double strength = yield_stress + hardening_modulus * alpha;
      const double square   = 3. * second_invariant(tau);
      if (square <= strength * strength)
        return false;
      const double q = std::sqrt(square);
      const double gamma =
        (q - strength) / (3. * elastic.shear + hardening_modulus);
      alpha += gamma;
      const double factor = (strength + hardening_modulus * gamma) / q;
      if (tangent != nullptr)
        set_tangent(*tangent,
                    tau,
                    factor * q / std::sqrt(3.),
                    hardening_modulus /
                      (3. * elastic.shear + hardening_modulus),
                    0.,
                    0.,
                    1.);
      scale_deviator(tau, factor, mean_of(tau));
      return true;
    }

  private:
    double yield_stress      = 1e3;
    double hardening_modulus = 0.;
  };
} // namespace greville

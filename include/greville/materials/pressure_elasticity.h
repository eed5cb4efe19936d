// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky.h>
#include <greville/materials/material_lanes.h>
#include <greville/materials/parameter_checks.h>

namespace greville
{
  /**
   * Hyperelasticity of soil in principal logarithmic strains eps_a, with a bulk
   * modulus that grows with the pressure and a constant shear modulus (@ref
   * Borja1998 "Borja and Tamagnini, 1998", with alpha = 0, for which volume and
   * shear are not coupled). With the deviatoric strains e_a, eps_v = sum_a
   * eps_a, and the Kirchhoff stress tau:
   *   W = a (eps_v + kappa (exp(-eps_v / kappa) - 1)) + G sum_a e_a^2,
   *   tau_a = a (1 - exp(-eps_v / kappa)) + 2 G e_a.
   * P = a - tr(tau) / 3 = a exp(-eps_v / kappa) > 0 is the pressure above the
   * apex, at which the soil tears. The mean stress is below the attraction a in
   * any deformation. The bulk modulus is P / kappa, and a change of pressure
   * from P_1 to P_2 changes ln V by -kappa ln(P_2 / P_1). (A part alpha P of
   * the shear modulus would couple volume and shear. Without a constant part,
   * it would limit q / P to sqrt(3 alpha kappa / 2).)
   *
   * Parameters: "Shear modulus" G, Pa, "Swelling slope" kappa, and "Attraction"
   * a, Pa.
   */
  class PressureElasticity
  {
  public:
    void
    declare(dealii::ParameterHandler &prm)
    {
      add_parameter(prm, "Shear modulus", shear, positive())(
        "Elastic shear modulus G, of any pressure. Unit: Pa.");
      add_parameter(prm, "Swelling slope", kappa, positive())(
        "Elastic decrease of the logarithm of the volume with that of the "
        "pressure: kappa / (1 + e). Unit: none.");
      add_parameter(prm, "Attraction", attraction, positive())(
        "The mean tension at which the soil tears, which is added to the "
        "pressure: c cot(phi) of a cohesion c. Unit: Pa.");
    }

    void
    reinit(const std::string &)
    {}

    template <typename Number>
    Number
    energy(const std::array<Number, 3> &strain) const
    {
      const Number trace = strain[0] + strain[1] + strain[2], mean = trace / 3.;
      const Number e0 = strain[0] - mean, e1 = strain[1] - mean,
                   e2 = strain[2] - mean;
      return (attraction * kappa) * exp_less_one_less(trace * (-1. / kappa)) +
             shear * (e0 * e0 + e1 * e1 + e2 * e2);
    }

    /// See ElasticConstants::wave_modulus().
    template <typename Number>
    Number
    wave_modulus(const std::array<Number, 3> &tau,
                 const Number                &inverse_J) const
    {
      const Number pressure = attraction - (tau[0] + tau[1] + tau[2]) / 3.;
      const Number modulus  = pressure * (1. / kappa) + 4. / 3. * shear;
      const Number smallest = smaller_of(tau[0], smaller_of(tau[1], tau[2]));
      return larger_of(modulus - smallest, Number(1e-2 * modulus)) * inverse_J;
    }

    Moduli
    moduli() const
    {
      return {attraction / kappa, shear, 0.};
    }

    /// Fill stress, F, J and wave_modulus of @p point for a Cauchy stress
    /// sigma, set @p e to b - 1, and return eps. ln J solves exp(ln J)
    /// tr(sigma) / 3 = a (1 - exp(-ln J / kappa)). Throws dealii::ExcMessage if
    /// there is no solution.
    Principal
    invert(MaterialPoint                       &point,
           dealii::SymmetricTensor<2, 3>       &e,
           const dealii::SymmetricTensor<2, 3> &sigma,
           const char                          *material) const
    {
      const Spectrum spectrum(sigma);
      const double   mean  = trace(sigma) / 3.;
      double         log_J = 0., change = 1.;
      for (unsigned int i = 0; i < 200 && std::abs(change) > 0.; ++i)
        {
          const double next =
            -kappa * std::log1p(-std::exp(log_J) * mean / attraction);
          change = next - log_J;
          log_J  = next;
          if (!(std::abs(change) > 1e-16 * std::abs(log_J)))
            break;
        }
      check_stress(
        std::isfinite(sigma.norm()) && std::isfinite(log_J) &&
          std::abs(change) <= 1e-14 * std::abs(log_J) + 1e-300,
        material,
        sigma,
        [&]() {
          return "the mean stress has to be smaller than the attraction, " +
                 text_of(attraction) + " Pa";
        });
      point.J = std::exp(log_J);
      Principal eps, stretch, tau;
      for (unsigned int a = 0; a < 3; ++a)
        {
          tau[a]     = point.J * spectrum.values[a];
          eps[a]     = log_J / 3. + (tau[a] - point.J * mean) / (2. * shear);
          stretch[a] = std::exp(eps[a]);
        }
      e                  = spectrum.tensor(stretches_less_one(eps));
      point.F            = spectrum.tensor(stretch);
      point.stress       = sigma;
      point.wave_modulus = wave_modulus(tau, 1. / point.J);
      return eps;
    }

    double shear      = 3e6;
    double kappa      = 0.01;
    double attraction = 100.;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky.h>
#include <greville/materials/material_lanes.h>
#include <greville/materials/parameter_checks.h>

namespace greville
{
  /**
   * Isotropic linear elasticity between principal logarithmic strains eps_a
   * and principal Kirchhoff stresses tau_a, Pa (H. Hencky 1928; de Souza Neto,
   * Peric, Owen, Computational Methods for Plasticity, section 13.2):
   *   tau_a = lambda (eps_1 + eps_2 + eps_3) + 2 G eps_a,
   *   W = lambda (eps_1 + eps_2 + eps_3)^2 / 2 + G sum_a eps_a^2,
   *   lambda = E nu / ((1 + nu) (1 - 2 nu)), G = E / (2 (1 + nu)),
   *   K = lambda + 2 G / 3.
   */
  class ElasticConstants
  {
  public:
    void
    declare(dealii::ParameterHandler &prm)
    {
      add_parameter(prm, "Young modulus", youngs_modulus, positive())(
        "Young's modulus E. Unit: Pa.");
      using dealii::Patterns::Double;
      add_parameter(prm, "Poisson ratio", poissons_ratio, Double(-1., 0.5))(
        "Poisson's ratio nu, between -1 and 0.5 (both excluded). Unit: none.");
    }

    /// Compute the constants. Throws dealii::ExcMessage unless -1 < nu < 0.5.
    void
    reinit(const std::string &section)
    {
      check_parameter(poissons_ratio > -1. && poissons_ratio < 0.5,
                      section,
                      "Poisson ratio",
                      poissons_ratio,
                      "greater than -1 and smaller than 0.5");
      const double E = youngs_modulus, nu = poissons_ratio;
      lambda = E * nu / ((1. + nu) * (1. - 2. * nu));
      shear  = E / (2. * (1. + nu));
      bulk   = E / (3. * (1. - 2. * nu));
    }

    template <typename Number>
    std::array<Number, 3>
    stress(const std::array<Number, 3> &strain) const
    {
      const Number p = lambda * (strain[0] + strain[1] + strain[2]);
      return {{p + 2. * shear * strain[0],
               p + 2. * shear * strain[1],
               p + 2. * shear * strain[2]}};
    }

    template <typename Number>
    std::array<Number, 3>
    strain(const std::array<Number, 3> &tau) const
    {
      const Number mean = (tau[0] + tau[1] + tau[2]) / 3.;
      const double a    = 1. / (2. * shear);
      const Number b    = mean * (1. / (3. * bulk) - a);
      return {{a * tau[0] + b, a * tau[1] + b, a * tau[2] + b}};
    }

    template <typename Number>
    Number
    energy(const std::array<Number, 3> &strain) const
    {
      const Number trace = strain[0] + strain[1] + strain[2];
      return 0.5 * lambda * trace * trace +
             shear * (strain[0] * strain[0] + strain[1] * strain[1] +
                      strain[2] * strain[2]);
    }

    /// Return the modulus of longitudinal waves in Hencky's law: the largest of
    /// the values rho c^2 = (K + 4 G / 3 - tau_a) / J along the principal
    /// directions a. It vanishes in strong tension, as the law softens. Time
    /// steps and estimates need a positive modulus, so the wave speed is at
    /// least a tenth of its value in the stress-free state.
    template <typename Number>
    Number
    wave_modulus(const std::array<Number, 3> &tau,
                 const Number                &inverse_J) const
    {
      const double modulus  = bulk + 4. / 3. * shear;
      const Number smallest = smaller_of(tau[0], smaller_of(tau[1], tau[2]));
      return larger_of(modulus - smallest, Number(1e-2 * modulus)) * inverse_J;
    }

    Moduli
    moduli() const
    {
      return {bulk, shear, 0.};
    }

    /// Invert Hencky's law: fill stress, F, J and wave_modulus of @p point, set
    /// @p e to b - 1, and return the principal Kirchhoff stresses. ln J solves
    /// ln J = J tr(sigma) / (3 K). For tr(sigma) / 3 > K / exp(1), there is no
    /// solution: throws dealii::ExcMessage.
    Principal
    invert_hencky(MaterialPoint                       &point,
                  dealii::SymmetricTensor<2, 3>       &e,
                  const dealii::SymmetricTensor<2, 3> &sigma,
                  const char                          *material) const
    {
      const Spectrum spectrum(sigma);
      const double   pressure = trace(sigma) / (3. * bulk);
      check_stress(
        pressure < std::exp(-1.) && std::isfinite(sigma.norm()),
        material,
        sigma,
        [&]() {
          return "the mean stress has to be smaller than K / exp(1) = " +
                 text_of(bulk * std::exp(-1.)) + " Pa";
        });
      // Newton's method approaches from one side.
      double log_J = 0.;
      for (unsigned int i = 0; i < 100; ++i)
        {
          const double q      = pressure * std::exp(log_J);
          const double change = (q - log_J) / (1. - q);
          log_J += change;
          if (std::abs(change) <= 1e-16 * std::abs(log_J))
            break;
        }
      point.J = std::exp(log_J);
      Principal tau, stretch;
      for (unsigned int a = 0; a < 3; ++a)
        tau[a] = point.J * spectrum.values[a];
      const Principal eps = strain(tau);
      for (unsigned int a = 0; a < 3; ++a)
        stretch[a] = std::exp(eps[a]);
      e                  = spectrum.tensor(stretches_less_one(eps));
      point.F            = spectrum.tensor(stretch);
      point.stress       = sigma;
      point.wave_modulus = wave_modulus(tau, 1. / point.J);
      return tau;
    }

    double youngs_modulus = 1e6;
    double poissons_ratio = 0.3;
    double lambda = 0., bulk = 0., shear = 0.;
  };



  /// A base class of laws with elastic constants. It derives from @p Base, a
  /// Material or a MaterialLaw, and contains ElasticConstants or another
  /// elastic law with the same functions.
  template <typename Base, typename Elastic = ElasticConstants>
  class ElasticMaterial : public Base
  {
  public:
    void
    declare(dealii::ParameterHandler &prm) override
    {
      Base::declare(prm);
      elastic.declare(prm);
    }

    void
    reinit(const std::string &section) override
    {
      elastic.reinit(section);
    }

    Moduli
    moduli() const override
    {
      return elastic.moduli();
    }

  protected:
    Elastic elastic;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/tait_fluid.h>

namespace greville
{
  /**
   * A weakly compressible Bingham fluid, regularized (@ref Papanastasiou1987
   * "Papanastasiou, 1987"): TaitFluid (pressure, rate d, state, exceptions)
   * with the shear stress
   *   2 eta dev(d), eta = mu + tau_y (1 - exp(-m g)) / g,
   *   g = sqrt(2 dev(d) : dev(d)),
   * so that simple shear at a rate g has the shear stress mu g + tau_y (1 -
   * exp(-m g)). For m g >> 1, this is Bingham's law; for m g << 1, it is a
   * Newtonian fluid of the largest viscosity mu + tau_y m, which creeps at any
   * stress.
   * Parameters: mu ("Plastic viscosity", Pa s), tau_y ("Yield stress", Pa, in
   * simple shear), m ("Regularization", s).
   */
  class Bingham : public TaitFluid<Bingham>
  {
  public:
    static constexpr const char *name = "bingham";

    void
    declare(dealii::ParameterHandler &prm) override
    {
      TaitFluid<Bingham>::declare(prm);
      using dealii::Patterns::Double;
      add_parameter(prm, "Yield stress", yield_stress, Double(0.))(
        "Shear stress at which the fluid yields. Unit: Pa.");
      add_parameter(prm, "Plastic viscosity", mu, Double(0.))(
        "Growth of the shear stress with the shear rate after yield. Unit: Pa "
        "s.");
      add_parameter(prm, "Regularization", regularization, positive())(
        "Time m of the regularization: at shear rates below 1 / m the fluid is "
        "very viscous instead of rigid. Unit: s.");
    }

    double
    viscosity(const double square) const
    {
      const double rate = std::sqrt(square);
      const double x    = regularization * rate;
      return mu + (x > 1e-20 ? -yield_stress * std::expm1(-x) / rate
                             : yield_stress * regularization);
    }

    /// Return tau_y (x exp(-x) + exp(-x) - 1) / (2 g^3) with x = m g, by its
    /// power series for small x.
    double
    viscosity_slope(const double square) const
    {
      const double rate = std::sqrt(square);
      const double x    = regularization * rate;
      if (x <= 1e-20)
        return 0.;
      const double sum =
        x < 1e-2 ? -x * x *
                     (1. / 2. -
                      x * (1. / 3. - x * (1. / 8. - x * (1. / 30. - x / 144.))))
                 : x * std::exp(-x) + std::expm1(-x);
      return yield_stress * sum / (2. * square * rate);
    }

    double
    largest_viscosity() const
    {
      return mu + yield_stress * regularization;
    }

  private:
    double yield_stress   = 10.;
    double mu             = 0.1;
    double regularization = 1.;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/tait_fluid.h>

namespace greville
{
  /// A weakly compressible Newtonian fluid: TaitFluid (pressure, rate d, state,
  /// exceptions) with the shear stress 2 mu dev(d), mu the parameter
  /// "Viscosity", Pa s.
  class NewtonianFluid : public TaitFluid<NewtonianFluid>
  {
  public:
    static constexpr const char *name = "newtonian-fluid";

    void
    declare(dealii::ParameterHandler &prm) override
    {
      TaitFluid<NewtonianFluid>::declare(prm);
      add_parameter(prm, "Viscosity", mu, dealii::Patterns::Double(0.))(
        "Dynamic viscosity of shear. Unit: Pa s.");
    }

    double
    viscosity(const double) const
    {
      return mu;
    }

    double
    viscosity_slope(const double) const
    {
      return 0.;
    }

    double
    largest_viscosity() const
    {
      return mu;
    }

  private:
    double mu = 1e-3;
  };
} // namespace greville

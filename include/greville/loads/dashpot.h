// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/loads/surface_load.h>

#include <cmath>

namespace greville
{
  /**
   * A boundary that absorbs waves of normal incidence (J. Lysmer, R.
   * Kuhlemeyer, Finite dynamic model for infinite media, 1969):
   *   -rho (c_p v_n n + c_s v_t)
   * with the current normal n and the wave speeds of the body's material.
   */
  class Dashpot : public SurfaceLoadKindOf<Dashpot>
  {
  public:
    static constexpr const char *name = "dashpot";

    void
    declare(dealii::ParameterHandler &) override
    {}

    template <int dim>
    class Load : public SurfaceLoad<dim>
    {
    public:
      Load(const Dashpot &, const LoadedBody &body)
      {
        const Moduli moduli = body.material.moduli();
        const double rho    = body.material.density;
        normal  = std::sqrt(rho * (moduli.bulk + 4. / 3. * moduli.shear));
        tangent = std::sqrt(rho * moduli.shear);
      }

      dealii::Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double) const override
      {
        dealii::Tensor<1, dim> n = state.area_vector();
        n /= n.norm();
        return -tangent * state.velocity -
               (normal - tangent) * (state.velocity * n) * n;
      }

      double
      damping() const override
      {
        return normal;
      }

    private:
      double normal, tangent; // rho c, Pa s / m
    };
  };
} // namespace greville

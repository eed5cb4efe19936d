// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky_law.h>
#include <greville/materials/left_cauchy_green.h>

namespace greville
{
  /**
   * Linear elasticity in logarithmic strains (H. Hencky 1928):
   *   eps = ln(F F^T) / 2,
   *   tau = lambda tr(eps) 1 + 2 G eps = dW / d eps,
   *   W = lambda tr(eps)^2 / 2 + G eps : eps,
   *   sigma = tau / J
   * with the Kirchhoff stress tau and the Cauchy stress sigma, Pa. Small
   * strains give Hooke's law; large ones are hyperelastic. In tension the
   * Cauchy stress has a maximum (mean stress K / exp(1) at ln J = 1).
   *
   * reinit() throws dealii::ExcMessage for a Poisson's ratio outside of (-1,
   * 0.5), initialize() for a mean stress of K / exp(1) or more.
   */
  class LinearElastic : public HenckyLaw<LinearElastic>
  {
  public:
    static constexpr const char *name = "linear-elastic";

    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      dealii::SymmetricTensor<2, 3> e;
      elastic.invert_hencky(point, e, stress, name);
    }

    bool
    has_symmetric_tangent() const override
    {
      return true;
    }

    std::array<Lanes, 6>
    trial(const MaterialLanes &points) const
    {
      return left_cauchy_green_less_one(points.F);
    }

    std::array<Lanes, 6>
    current(const MaterialLanes &points) const
    {
      return trial(points);
    }

    Lanes
    heat(const MaterialLanes &) const
    {
      return 0.;
    }

    std::array<Lanes, 3>
    respond(MaterialLanes &,
            const SpectralDecomposition<Lanes> &,
            const std::array<Lanes, 6> &,
            const std::array<Lanes, 3> &eps) const
    {
      return elastic.stress(eps);
    }

    PrincipalTangent
    linearize(const MaterialLanes &, const std::array<Lanes, 3> &eps) const
    {
      return elastic_tangent(eps);
    }
  };
} // namespace greville

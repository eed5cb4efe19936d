// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/elastic_constants.h>
#include <greville/materials/left_cauchy_green.h>

namespace greville
{
  /**
   * The compressible neo-Hookean law (@ref Bonet2008 "Bonet and Wood, 2008",
   * section 6.4.3):
   * @f{align*}{
   *   W &= \tfrac{\mu}{2} (F : F - 3) - \mu \ln J
   *        + \tfrac{\lambda}{2} (\ln J)^2, \\
   *   P &= \frac{\partial W}{\partial F}
   *      = \lambda \ln J \, F^{-T} + \mu (F - F^{-T}), \\
   *   \sigma &= \frac{1}{J} P F^T
   *          = \frac{1}{J} (\lambda \ln J \, 1 + \mu (F F^T - 1))
   * @f}
   * with Lame's constants lambda and mu = G from E and nu; stresses in Pa. With
   * nu = 0 and thus mu = E / 2, a bar in uniaxial strain F has P = E / 2 (F - 1
   * / F), the law of one-dimensional manufactured solutions.
   *
   * A wave along a principal stretch s has rho c^2 = (lambda (1 - ln(J)) + mu +
   * mu s^2) / J. For s^2, wave_modulus uses the upper bound tr(b) / 3 + sqrt(2
   * / 3) |dev(b)| of the eigenvalues of b = F F^T. The bracket vanishes at
   * large J; it is at least lambda / 100 + mu / 50.
   *
   * reinit() throws dealii::ExcMessage for a Poisson's ratio outside of (-1,
   * 0.5), and initialize() for a stress that no deformation produces.
   */
  class NeoHookean : public ElasticMaterial<LanesMaterial>
  {
  public:
    static constexpr const char *name = "neo-hookean";

    /// Solve b_1 b_2 b_3 = J^2 for ln J with the principal values b_a = 1 +
    /// e_a, e_a = (J sigma_a - lambda ln(J)) / mu.
    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      const Spectrum spectrum(stress);
      const double   lambda = elastic.lambda, mu = elastic.shear;

      // Use Newton's method with a limited step. If some b_a is not positive,
      // move ln J in the direction in which this b_a grows.
      double    log_J     = 0.;
      bool      converged = false;
      Principal stretch;
      for (unsigned int i = 0; i < 200 && !converged; ++i)
        {
          double value = -2. * log_J, slope = -2., outside = 0.;
          for (unsigned int a = 0; a < 3; ++a)
            {
              const double tau = std::exp(log_J) * spectrum.values[a];
              const double e   = (tau - lambda * log_J) / mu;
              if (!(e > -1.))
                outside = tau < lambda ? -0.1 : 0.1;
              value += std::log1p(e);
              slope += (tau - lambda) / (mu * (1. + e));
              stretch[a] = std::sqrt(1. + e);
            }
          const double change =
            outside != 0. ? outside
                          : std::min(std::max(-value / slope, -0.2), 0.2);
          converged = std::abs(change) <= 1e-15;
          if (!converged)
            log_J += change;
        }
      check_stress(
        converged && std::isfinite(stress.norm()), name, stress, [&]() {
          return "no deformation gives it with lambda = " + text_of(lambda) +
                 " Pa and mu = " + text_of(mu) + " Pa";
        });
      point.J = std::exp(log_J);
      point.F = spectrum.tensor(stretch);
      update(dealii::make_array_view(&point, &point + 1));
      point.stress = stress;
    }

    void
    update_lanes(MaterialLanes &points) const override
    {
      const double mu        = elastic.shear;
      const Lanes  inverse_J = 1. / points.J;
      const Lanes  p         = elastic.lambda * log_of_one_plus(points.J - 1.);

      const std::array<Lanes, 6> e      = left_cauchy_green_less_one(points.F);
      const Lanes                mean   = (e[0] + e[1] + e[2]) * (1. / 3.);
      Lanes                      square = 0.;
      for (unsigned int i = 0; i < 3; ++i)
        {
          const Lanes d = e[i] - mean;
          square += d * d + 2. * e[i + 3] * e[i + 3];
        }
      const Lanes  largest = 1. + mean + sqrt(2. / 3. * square);
      const double modulus = elastic.lambda + 2. * mu;
      points.wave_modulus  = larger_of(elastic.lambda - p + mu + mu * largest,
                                      Lanes(1e-2 * modulus)) *
                            inverse_J;
      for (unsigned int i = 0; i < 3; ++i)
        {
          points.stress[i]     = (p + mu * e[i]) * inverse_J;
          points.stress[i + 3] = mu * e[i + 3] * inverse_J;
        }
    }

    /// The energy is exact up to relative round-off, also for small strains.
    /// Steps that conserve energy divide its change by the change of strain.
    EnergyLanes
    energies(const MaterialLanes &points) const override
    {
      const Lanes         log_J = log_of_one_plus(points.J - 1.);
      const SquaredVolume volume(left_cauchy_green_less_one(points.F));
      EnergyLanes         result;
      result.strain =
        0.5 * elastic.shear *
          (less_log_of_one_plus(volume.less_one) - volume.nonlinear) +
        0.5 * elastic.lambda * log_J * log_J;
      return result;
    }

    void
    tangent_lanes(const MaterialLanes &points,
                  TangentLanes        &D,
                  const unsigned int   dim) const override
    {
      // J D = lambda 1 x 1 + (change of mu b) - J sigma x 1
      const Lanes inverse_J = 1. / points.J, mu = elastic.shear * inverse_J;
      const Lanes volumetric =
        elastic.lambda * inverse_J * (1. - log_of_one_plus(points.J - 1.)) + mu;
      std::array<Lanes, 6> b = left_cauchy_green_less_one(points.F);
      for (unsigned int e = 0; e < 6; ++e)
        b[e] = mu * (e < 3 ? 1. + b[e] : b[e]);
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
#pragma GCC unroll 6
          for (unsigned int e = 0; e < 6; ++e)
            {
              Lanes sum = change_of_left_cauchy_green(b, e, k, l);
              if (k == l)
                sum += e < 3 ? volumetric - b[e] : -b[e];
              D[e][3 * k + l] = sum;
            }
    }

    bool
    has_symmetric_tangent() const override
    {
      return true;
    }
  };
} // namespace greville

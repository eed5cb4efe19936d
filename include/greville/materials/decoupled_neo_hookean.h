// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/elastic_constants.h>
#include <greville/materials/left_cauchy_green.h>

namespace greville
{
  /**
   * The neo-Hookean law whose energy is the sum of a volumetric and an
   * isochoric part (@ref Simo1985 "Simo, Taylor and Pister, 1985"; @ref
   * Simo1998 "Simo and Hughes, 1998", section 9.2):
   * @f{align*}{
   *   W &= \tfrac{K}{4} (J^2 - 1 - 2 \ln J)
   *        + \tfrac{\mu}{2} (\mathrm{tr}\, \bar b - 3),
   *   \quad \bar b = J^{-2/3} F F^T, \\
   *   J \sigma &= \tfrac{K}{2} (J^2 - 1) \, 1 + \mu \, \mathrm{dev}\, \bar b
   * @f}
   * with K and mu = G from E and nu; stresses in Pa. In plane strain, bbar
   * includes its entry along z.
   *
   * A wave along a principal stretch s has rho c^2 = (K (J^2 + 1) / 2 + mu (5
   * tr(bbar) - 3 J^(-2/3) s^2) / 9) / J, which is positive. For s^2,
   * wave_modulus uses the lower bound tr(b) / 3 - sqrt(2 / 3) |dev(b)| of the
   * eigenvalues of b = F F^T.
   *
   * reinit() throws dealii::ExcMessage for a Poisson's ratio outside of (-1,
   * 0.5), and initialize() for a stress that is not finite. Each finite stress
   * belongs to one deformation.
   */
  class DecoupledNeoHookean : public ElasticMaterial<LanesMaterial>
  {
  public:
    static constexpr const char *name = "decoupled-neo-hookean";

    /// Solve K (J^2 - 1) = 2 J p for J. The principal values of bbar are m +
    /// e_a, with e_a = J s_a / mu and the deviator s of sigma; their product is
    /// one, which determines m. Newton's method for m starts from above, where
    /// the product is convex.
    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      check_stress(std::isfinite(stress.norm()),
                   name,
                   stress,
                   "it has to be finite");
      const Spectrum spectrum(stress);
      const double   K = elastic.bulk, p = trace(stress) / 3.,
                   root = std::hypot(p, K);
      point.J           = p > 0. ? (p + root) / K : K / (root - p);

      Principal e;
      double    m = 1.;
      for (unsigned int a = 0; a < 3; ++a)
        {
          e[a] = point.J * (spectrum.values[a] - p) / elastic.shear;
          m    = std::max(m, 1. - e[a]);
        }
      for (unsigned int i = 0; i < 200; ++i)
        {
          const double x = m + e[0], y = m + e[1], z = m + e[2];
          const double change = (x * y * z - 1.) / (x * y + y * z + z * x);
          m -= change;
          if (change <= 1e-16 * m)
            break;
        }
      Principal stretch;
      for (unsigned int a = 0; a < 3; ++a)
        stretch[a] = std::cbrt(point.J) * std::sqrt(m + e[a]);
      point.F = spectrum.tensor(stretch);
      update(dealii::make_array_view(&point, &point + 1));
      point.stress = stress;
    }

    void
    update_lanes(MaterialLanes &points) const override
    {
      const Lanes         &J         = points.J;
      const Lanes          mu        = elastic.shear * shape_factor(J);
      const Lanes          inverse_J = 1. / J;
      std::array<Lanes, 6> s         = left_cauchy_green_less_one(points.F);
      const Lanes          mean      = (s[0] + s[1] + s[2]) * (1. / 3.);
      Lanes                square    = 0.;
      for (unsigned int i = 0; i < 3; ++i)
        {
          s[i] -= mean;
          square += s[i] * s[i] + 2. * s[i + 3] * s[i + 3];
        }
      points.wave_modulus =
        inverse_J * (0.5 * elastic.bulk * (J * J + 1.) +
                     mu * (4. / 3. * (1. + mean) + sqrt(2. / 27. * square)));
      const Lanes p = pressure(J);
      for (unsigned int i = 0; i < 3; ++i)
        {
          points.stress[i]     = mu * inverse_J * s[i] + p;
          points.stress[i + 3] = mu * inverse_J * s[i + 3];
        }
    }

    /// The energy is exact up to relative round-off, see NeoHookean. With
    /// ln(det(b)) = 3 q, tr(bbar) / 3 - 1 = exp(-q) (tr(b) / 3 - 1 - (exp(q) -
    /// 1)), where all terms linear in b - 1 cancel.
    EnergyLanes
    energies(const MaterialLanes &points) const override
    {
      const Lanes         x = points.J - 1.;
      const SquaredVolume volume(left_cauchy_green_less_one(points.F));
      const Lanes         q = log_of_one_plus(volume.less_one) / 3.;
      EnergyLanes         result;
      result.strain =
        0.25 * elastic.bulk * (x * x + 2. * less_log_of_one_plus(x)) +
        0.5 * elastic.shear * (1. + exp_less_one(Lanes(-q))) *
          (less_log_of_one_plus(volume.less_one) - volume.nonlinear -
           3. * exp_less_one_less(q));
      return result;
    }

    void
    tangent_lanes(const MaterialLanes &points,
                  TangentLanes        &D,
                  const unsigned int   dim) const override
    {
      // J D = K J^2 1 x 1 - J sigma x 1 + mu (change of bbar, deviator)
      const Lanes         &J  = points.J;
      const Lanes          mu = elastic.shear * shape_factor(J) / J;
      std::array<Lanes, 6> b  = left_cauchy_green_less_one(points.F);
      for (unsigned int e = 0; e < 6; ++e)
        b[e] = mu * (e < 3 ? 1. + b[e] : b[e]);
      const Lanes mean       = (b[0] + b[1] + b[2]) * (1. / 3.);
      const Lanes volumetric = elastic.bulk * J - pressure(J);
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
          for (unsigned int e = 0; e < 6; ++e)
            {
              Lanes sum = change_of_left_cauchy_green(b, e, k, l);
              if (e < 3)
                sum -= 2. / 3. * b[number_of_entry[k][l]];
              if (k == l)
                sum += e < 3 ? volumetric - 5. / 3. * (b[e] - mean)
                             : -5. / 3. * b[e];
              D[e][3 * k + l] = sum;
            }
    }

    bool
    has_symmetric_tangent() const override
    {
      return true;
    }

  private:
    /// Return J^(-2/3), or NaN if J is not positive.
    static Lanes
    shape_factor(const Lanes &J)
    {
      return 1. + exp_less_one(-2. / 3. * log_of_one_plus(J - 1.));
    }

    /// Return the mean Cauchy stress.
    Lanes
    pressure(const Lanes &J) const
    {
      return 0.5 * elastic.bulk * (J - 1.) * (J + 1.) / J;
    }
  };
} // namespace greville

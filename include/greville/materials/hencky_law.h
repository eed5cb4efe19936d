// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/elastic_constants.h>

namespace greville
{
  /// Principal Kirchhoff stresses tau_a of points, their derivatives d tau_a /
  /// d eps_b by the trial strains, and (tau_a - tau_b) / (eps_a - eps_b) for
  /// (a, b) = (0, 1), (0, 2), (1, 2), Pa.
  struct PrincipalTangent
  {
    std::array<Lanes, 3>                stress;
    std::array<std::array<Lanes, 3>, 3> moduli;
    std::array<Lanes, 3>                secants;
  };



  /**
   * Base class of laws in logarithmic elastic strains eps. It has the elastic
   * constants and the stored energy, and computes stresses from strains in
   * principal axes, for as many points at once as Lanes contain.
   *
   * A @p Law has
   *   std::array<Lanes, 6> trial(const MaterialLanes &points) const,
   * the elastic left Cauchy-Green tensor less the identity, b - 1, at the end
   * of a step without plastic flow;
   *   std::array<Lanes, 6> current(const MaterialLanes &points) const,
   *   Lanes heat(const MaterialLanes &points) const,
   * the same tensor for points whose state is up to date, and their
   * dissipation;
   *   std::array<Lanes, 3>
   *   respond(MaterialLanes &points,
   *           const SpectralDecomposition<Lanes> &spectrum,
   *           const std::array<Lanes, 6> &e, std::array<Lanes, 3> eps) const,
   * which updates the state of points from the trial tensor e, its spectrum and
   * its strains eps and returns the principal Kirchhoff stresses; and
   *   PrincipalTangent
   *   linearize(const MaterialLanes &points,
   *             const std::array<Lanes, 3> &eps) const,
   * the derivatives of these stresses.
   *
   * The tangent is the derivative of an isotropic function tau of the trial
   * tensor b (de Souza Neto, Peric, Owen, appendix A): a change l has db = l b
   * + b l^T, in principal axes d eps_a = l_aa and
   *   d tau_aa = sum_b (d tau_a / d eps_b) l_bb,
   *   d tau_ab = (tau_a - tau_b) / (b_a - b_b) (b_b l_ab + b_a l_ba).
   * With tau_a - tau_b = s_ab (eps_a - eps_b), where laws compute s_ab without
   * cancellation, and x = b_a / b_b - 1, the last line becomes
   *   d tau_ab = s_ab ln(1 + x) / (2 x) (l_ab + (1 + x) l_ba),
   * which is exact to round-off even if values are close or equal.
   *
   * @p Elastic has the functions of ElasticConstants that this class calls.
   */
  template <typename Law, typename Elastic = ElasticConstants>
  class HenckyLaw : public ElasticMaterial<LanesMaterial, Elastic>
  {
  public:
    void
    update_lanes(MaterialLanes &points) const final
    {
      const std::array<Lanes, 6>         e         = law().trial(points);
      const Lanes                        inverse_J = inverse_of(points.J);
      const SpectralDecomposition<Lanes> spectrum(e);
      std::array<Lanes, 3>               tau = law().respond(
        points, spectrum, e, logarithmic_strains(spectrum.values));
      points.wave_modulus = elastic.wave_modulus(tau, inverse_J);
      for (Lanes &t : tau)
        t *= inverse_J;
      points.stress = spectrum.assemble(tau);
    }

    void
    tangent_lanes(const MaterialLanes &points,
                  TangentLanes        &D,
                  const unsigned int   dim) const final
    {
      const Lanes                        inverse_J = inverse_of(points.J);
      const SpectralDecomposition<Lanes> spectrum(law().trial(points));
      const auto                         n = spectrum.directions();
      PrincipalTangent                   tangent =
        law().linearize(points, logarithmic_strains(spectrum.values));

      // The factors of l_ab and l_ba for pairs (a, b), and the tensors n_a
      // n_a^T and n_a n_b^T + n_b n_a^T.
      constexpr unsigned int first[] = {0, 0, 1}, second[] = {1, 2, 2};
      std::array<Lanes, 3>   there, back;
      std::array<Lanes, 6>   normal[3], shear[3];
      for (unsigned int pair = 0; pair < 3; ++pair)
        {
          const unsigned int a = first[pair], b = second[pair];
          const Lanes        x = (spectrum.values[a] - spectrum.values[b]) /
                          (1. + spectrum.values[b]);
          const Lanes ratio =
            choose(x == 0.,
                   Lanes(1.),
                   log_of_one_plus(x) / choose(x == 0., Lanes(1.), x));
          there[pair] = 0.5 * inverse_J * tangent.secants[pair] * ratio;
          back[pair]  = (1. + x) * there[pair];
        }
      for (unsigned int i = 0; i < 6; ++i)
        {
          const unsigned int r = entry_rows[i], c = entry_columns[i];
          for (unsigned int a = 0; a < 3; ++a)
            {
              normal[a][i] = n[a][r] * n[a][c];
              shear[a][i]  = n[first[a]][r] * n[second[a]][c] +
                            n[second[a]][r] * n[first[a]][c];
            }
        }
      for (unsigned int a = 0; a < 3; ++a)
        {
          tangent.stress[a] *= inverse_J;
          for (unsigned int b = 0; b < 3; ++b)
            tangent.moduli[a][b] *= inverse_J;
        }

      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
          {
            Lanes diagonal[3], other[3];
            for (unsigned int a = 0; a < 3; ++a)
              {
                diagonal[a] = tangent.moduli[a][0] * (n[0][k] * n[0][l]) +
                              tangent.moduli[a][1] * (n[1][k] * n[1][l]) +
                              tangent.moduli[a][2] * (n[2][k] * n[2][l]);
                if (k == l)
                  diagonal[a] -= tangent.stress[a];
                other[a] = there[a] * (n[first[a]][k] * n[second[a]][l]) +
                           back[a] * (n[second[a]][k] * n[first[a]][l]);
              }
            for (unsigned int i = 0; i < 6; ++i)
              D[i][3 * k + l] =
                (diagonal[0] * normal[0][i] + diagonal[1] * normal[1][i] +
                 diagonal[2] * normal[2][i]) +
                (other[0] * shear[0][i] + other[1] * shear[1][i] +
                 other[2] * shear[2][i]);
          }
    }

    EnergyLanes
    energies(const MaterialLanes &points) const override
    {
      EnergyLanes result;
      result.strain      = elastic.energy(logarithmic_strains(
        SpectralDecomposition<Lanes>(law().current(points)).values));
      result.dissipation = law().heat(points);
      return result;
    }

  protected:
    using ElasticMaterial<LanesMaterial, Elastic>::elastic;

    const Law &
    law() const
    {
      return static_cast<const Law &>(*this);
    }

    PrincipalTangent
    elastic_tangent(const std::array<Lanes, 3> &eps) const
    {
      PrincipalTangent tangent;
      tangent.stress = elastic.stress(eps);
      for (unsigned int a = 0; a < 3; ++a)
        {
          tangent.moduli[a].fill(elastic.lambda);
          tangent.moduli[a][a] += 2. * elastic.shear;
        }
      tangent.secants.fill(2. * elastic.shear);
      return tangent;
    }

  private:
    /// Return 1 / J, or NaN if J is not positive. The check is necessary
    /// because b = F F^T does not depend on the sign of J.
    static Lanes
    inverse_of(const Lanes &J)
    {
      return choose(J > 0.,
                    Lanes(1. / J),
                    Lanes(std::numeric_limits<double>::quiet_NaN()));
    }
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/elastoplastic_law.h>
#include <greville/materials/return_map.h>

namespace greville
{
  /**
   * Isotropic elastoplasticity with Hencky's elastic law (see
   * ElastoplasticLaw): the return in principal axes has the form of small
   * strains.
   *   b_e = f b_e f^T (trial), eps = ln(b_e) / 2,
   *   tau = lambda tr(eps) 1 + 2 G eps,
   *   eps = eps(trial) - sum_i dgamma_i dg_i / dtau,
   *   sigma = tau / J.
   * Yield functions take the Kirchhoff stress tau, Pa (per stress-free area and
   * volume), so the strength in terms of Cauchy stress is divided by J.
   *
   * State: the variables of ElastoplasticLaw, with the accumulated equivalent
   * plastic strain, d alpha = sqrt(2 / 3 dev(d eps_p) : dev(d eps_p)), and the
   * plastic work tau : d eps_p; for laws with a largest mean stress also the
   * opening v.
   *
   * The opening is the plastic volumetric strain (logarithmic, v >= 0) caused
   * by the largest mean stress, without dilatancy: separated grains or open
   * cracks. It must close before the material bears pressure again
   * (@ref Tampubolon2017 "Tampubolon et al., 2017", section 4.3). Otherwise,
   * each cycle of opening and closing would increase volume and pressure.
   * Therefore
   *   eps(trial) += w / 3 1, v -= w,
   * with w = v if the largest mean stress is 0; the return then opens again the
   * part that remains open. For a material that bears tension, w = min(v,
   * max(-tr(eps), 0)), so that it closes without stress. Closing does no
   * plastic work.
   *
   * A @p Law has
   *   static constexpr const char *name, *yield_condition;
   *   static constexpr bool opens,
   * true if it has an opening;
   *   double yield_function(const Principal &tau, double alpha,
   *                         double reduction) const,
   * positive for an inadmissible stress, Pa;
   *   bool return_map(Principal &tau, double &alpha, double &opening,
   *                   double reduction, ReturnTangent *tangent = nullptr)
   * const, which leaves an elastic trial stress unchanged and returns false;
   * otherwise it returns the stress to the yield surface, adds to alpha and to
   * the opening, and fills the @p tangent unless null (@p reduction is
   * MaterialPoint::strength_reduction); and, if it has an opening,
   *   double largest_mean_stress(double alpha) const, Pa.
   */
  template <typename Law>
  class HenckyPlasticity : public ElastoplasticLaw<Law>
  {
  public:
    std::vector<std::string>
    state_names() const override
    {
      return this->names_with(Law::opens ? std::vector<std::string>{"opening"}
                                         : std::vector<std::string>());
    }

    /// Initialize the state. Throws dealii::ExcMessage for a stress outside the
    /// yield surface by more than 1e-10 of its norm.
    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      dealii::SymmetricTensor<2, 3> e;
      const Principal tau = elastic.invert_hencky(point, e, stress, Law::name);
      const double f = law().yield_function(tau, 0., point.strength_reduction);
      check_stress(
        f <= 1e-10 * point.J * stress.norm(), Law::name, stress, [&]() {
          return std::string("the yield function ") + Law::yield_condition +
                 " of J times this stress is " + text_of(f) +
                 " Pa and has to be at most 0";
        });
      this->set_elastic(point, e);
    }

    std::array<Lanes, 3>
    respond(MaterialLanes                      &points,
            const SpectralDecomposition<Lanes> &spectrum,
            const std::array<Lanes, 6>         &e,
            std::array<Lanes, 3>                eps) const
    {
      auto &state                = points.state;
      bool  has_changed[n_lanes] = {}, any_changed = false;
      if constexpr (Law::opens)
        if (!all_of(state[opening] <= 0.))
          for (unsigned int lane = 0; lane < points.count; ++lane)
            if (state[opening][lane] > 0.)
              {
                const double open = state[opening][lane];
                state[opening][lane] =
                  open - close(eps, lane, open, state[plastic_strain][lane]);
                has_changed[lane] = any_changed = true;
              }

      const std::array<Lanes, 3> tau_trial = elastic.stress(eps);
      std::array<Lanes, 3>       tau       = tau_trial;
      for (unsigned int lane = 0; lane < points.count; ++lane)
        {
          double    alpha = state[plastic_strain][lane], opened = 0.;
          Principal t{{tau[0][lane], tau[1][lane], tau[2][lane]}};
          if constexpr (Law::opens)
            opened = state[opening][lane];
          if (law().return_map(t, alpha, opened, points.strength_reduction))
            {
              for (unsigned int a = 0; a < 3; ++a)
                tau[a][lane] = t[a];
              state[plastic_strain][lane] = alpha;
              if constexpr (Law::opens)
                state[opening][lane] = opened;
              has_changed[lane] = any_changed = true;
            }
        }
      std::copy_n(e.begin(), 6, state.first.begin());
      if (!any_changed)
        return tau;

      const std::array<Lanes, 3> flow = elastic.strain(std::array<Lanes, 3>{
        {tau_trial[0] - tau[0], tau_trial[1] - tau[1], tau_trial[2] - tau[2]}});
      const Lanes heat = tau[0] * flow[0] + tau[1] * flow[1] + tau[2] * flow[2];
      const std::array<Lanes, 6> returned =
        spectrum.assemble(stretches_less_one(elastic.strain(tau)));
      const Lanes::mask_type changed(has_changed,
                                     std::experimental::element_aligned);
      where(changed, state[work]) += heat;
      for (unsigned int i = 0; i < 6; ++i)
        where(changed, state[i]) = returned[i];
      return tau;
    }

    PrincipalTangent
    linearize(const MaterialLanes &points, std::array<Lanes, 3> eps) const
    {
      // Openings that close without stress remove volumetric strain.
      bool keeps_volume[n_lanes] = {};
      if constexpr (Law::opens)
        for (unsigned int lane = 0; lane < points.count; ++lane)
          if (points.state[opening][lane] > 0.)
            {
              const double open = points.state[opening][lane];
              const double closed =
                close(eps, lane, open, points.state[plastic_strain][lane]);
              keeps_volume[lane] = closed > 0. && closed < open;
            }

      const double     lambda = elastic.lambda, G = elastic.shear;
      PrincipalTangent tangent = this->elastic_tangent(eps);
      for (unsigned int lane = 0; lane < points.count; ++lane)
        {
          Principal tau{{tangent.stress[0][lane],
                         tangent.stress[1][lane],
                         tangent.stress[2][lane]}};
          double    alpha        = points.state[plastic_strain][lane],
                 opened          = points.state[opening][lane];
          ReturnTangent returned = {};
          if (law().return_map(
                tau, alpha, opened, points.strength_reduction, &returned))
            for (unsigned int a = 0; a < 3; ++a)
              {
                const auto  &slopes      = returned.slopes[a];
                const double sum         = slopes[0] + slopes[1] + slopes[2];
                tangent.stress[a][lane]  = tau[a];
                tangent.secants[a][lane] = 2. * G * returned.ratios[a];
                for (unsigned int b = 0; b < 3; ++b)
                  tangent.moduli[a][b][lane] =
                    lambda * sum + 2. * G * slopes[b];
              }
          if (keeps_volume[lane])
            for (auto &row : tangent.moduli)
              {
                const double mean =
                  (double(row[0][lane]) + row[1][lane] + row[2][lane]) / 3.;
                for (Lanes &modulus : row)
                  modulus[lane] = modulus[lane] - mean;
              }
        }
      return tangent;
    }

  protected:
    /// Return the equivalent plastic strain of a return from the Kirchhoff
    /// stress @p trial to @p returned, with 2 G dev(d eps_p) = dev(trial -
    /// returned).
    double
    equivalent_strain(const Principal &trial, const Principal &returned) const
    {
      const double a = trial[0] - returned[0], b = trial[1] - returned[1],
                   c = trial[2] - returned[2];
      return std::sqrt((a - b) * (a - b) + (b - c) * (b - c) +
                       (c - a) * (c - a)) *
             (std::sqrt(2.) / 6.) / elastic.shear;
    }

    using ElastoplasticLaw<Law>::elastic;
    using ElastoplasticLaw<Law>::law;

  private:
    using ElastoplasticLaw<Law>::plastic_strain;
    using ElastoplasticLaw<Law>::work;
    static constexpr unsigned int opening = ElastoplasticLaw<Law>::more;

    /// Close an opening as far as the elastic strain closes it, and return the
    /// closed part.
    double
    close(std::array<Lanes, 3> &eps,
          const unsigned int    lane,
          const double          open,
          const double          alpha) const
    {
      const double volume_strain =
        double(eps[0][lane]) + eps[1][lane] + eps[2][lane];
      const double closed = law().largest_mean_stress(alpha) > 0.
                              ? std::min(open, std::max(-volume_strain, 0.))
                              : open;
      for (Lanes &strain : eps)
        strain[lane] = strain[lane] + closed / 3.;
      return closed;
    }
  };

} // namespace greville

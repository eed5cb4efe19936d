// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/elastoplastic_law.h>
#include <greville/materials/pressure_elasticity.h>

namespace greville
{
  /// The trial state of a step without plastic flow.
  struct CriticalStateStep
  {
    /// ln(P / a), see PressureElasticity, and q = sqrt(3 J2), Pa.
    double log_pressure, q;
    /// The volume at the end of the step over the volume at its start.
    double volume;
  };



  /// ln(P / a) and q at the end of a step, and their derivatives by the trial
  /// state's eps_v and q.
  struct CriticalStateReturn
  {
    double log_pressure, q;
    double pressure_by_volume = 0., pressure_by_q = 0., q_by_volume = 0.,
           q_by_q = 1.;
  };



  /**
   * Base class of laws of critical state soil mechanics that depend on the
   * pressure and on q = sqrt(3 J2), not on Lode's angle: an ElastoplasticLaw
   * with PressureElasticity, whose return keeps the direction of the deviator,
   *   eps = eps_v / 3 1 + q / q(trial) e(trial).
   *
   * State: the variables of ElastoplasticLaw; the size of the yield surface,
   * Pa; the void ratio; and further variables of the law. All zeros stand for
   * the stress-free state, with the other variables from the parameters.
   *
   * Parameters: the parameters of PressureElasticity, "Critical stress ratio" M
   * = q / P in the critical state, and "Overconsolidation ratio" R.
   *
   * A @p Law has
   *   static constexpr const char *name, *size_name;
   *   static std::vector<std::string> more_names();
   *   void set_initial(State &state,
   *                    double log_pressure, double q) const,
   * which sets the size, the void ratio and the other variables of a point with
   * this stress;
   *   bool return_map(const CriticalStateStep &trial,
   *                   State &state,
   *                   CriticalStateReturn &result, bool differentiate) const,
   * which updates these variables; for an elastic step, it leaves the stress
   * unchanged and returns false.
   */
  template <typename Law>
  class CriticalStateLaw : public ElastoplasticLaw<Law, PressureElasticity>
  {
  public:
    using State = History<double>;

    void
    declare(dealii::ParameterHandler &prm) override
    {
      ElastoplasticLaw<Law, PressureElasticity>::declare(prm);
      add_parameter(prm, "Critical stress ratio", ratio, positive())(
        "M = q / p of the critical state: 6 sin(phi) / (3 - sin(phi)) for the "
        "friction angle phi in triaxial compression. Unit: none.");
      add_parameter(prm,
                    "Overconsolidation ratio",
                    overconsolidation,
                    dealii::Patterns::Double(1.))(
        "Size of the initial yield surface over the size of the surface "
        "through the initial stress. Unit: none.");
    }

    bool
    spreads() const override
    {
      return true;
    }

    std::vector<std::string>
    state_names() const override
    {
      auto names = Law::more_names();
      names.insert(names.begin(), {Law::size_name, "void_ratio"});
      return this->names_with(names);
    }

    /// Throw dealii::ExcMessage for a mean stress above the attraction, and for
    /// q > M P, that is, beyond the critical state.
    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      dealii::SymmetricTensor<2, 3> e;
      const Principal eps       = elastic.invert(point, e, stress, Law::name);
      const double log_pressure = -(eps[0] + eps[1] + eps[2]) / elastic.kappa,
                   pressure     = elastic.attraction * std::exp(log_pressure);
      // Use the stress, since the strains of stiff soil have round-off.
      const double q = point.J * std::sqrt(1.5) * deviator(stress).norm();
      check_stress(
        q <= (1. + 1e-12) * ratio * pressure, Law::name, stress, [&]() {
          return "q / (p + attraction) is " + text_of(q / pressure) +
                 " and has to be at most the critical stress ratio, " +
                 text_of(ratio);
        });
      this->set_elastic(point, e);
      law().set_initial(point.state, log_pressure, q);
    }

    std::array<Lanes, 3>
    respond(MaterialLanes                      &points,
            const SpectralDecomposition<Lanes> &spectrum,
            const std::array<Lanes, 6>         &e,
            const std::array<Lanes, 3>         &eps) const
    {
      std::array<Lanes, 3> tau = eps, elastic_strain = eps;
      bool                 has_changed[n_lanes] = {}, any_changed = false;
      const Lanes          volume = determinant(points.increment);
      for (Lanes &t : tau)
        t = 0.;
      for (unsigned int lane = 0; lane < points.count; ++lane)
        {
          State           state = state_of(points, lane);
          const Principal strain{{eps[0][lane], eps[1][lane], eps[2][lane]}};
          const Principal dev           = deviator_of(strain);
          const CriticalStateStep trial = make_trial(volume[lane], strain);
          CriticalStateReturn     end{trial.log_pressure, trial.q};
          has_changed[lane]   = law().return_map(trial, state, end, false);
          any_changed         = any_changed || has_changed[lane];
          const double factor = trial.q > 0. ? end.q / trial.q : 1.;
          const double mean   = mean_stress(end.log_pressure),
                       third  = -elastic.kappa * end.log_pressure / 3.;
          double heat         = 0.;
          for (unsigned int a = 0; a < 3; ++a)
            {
              tau[a][lane] = mean + 2. * elastic.shear * factor * dev[a];
              if (has_changed[lane])
                {
                  const double left       = third + factor * dev[a];
                  elastic_strain[a][lane] = left;
                  heat += tau[a][lane] * (strain[a] - left);
                }
            }
          if (has_changed[lane])
            {
              state[work] += heat;
              state[plastic_strain] += (trial.q - end.q) / (3. * elastic.shear);
            }
          for (unsigned int k = plastic_strain; k < points.n_state; ++k)
            points.state[k][lane] = state[k];
        }
      std::array<Lanes, 6> returned = e;
      if (any_changed)
        returned = spectrum.assemble(stretches_less_one(elastic_strain));
      const Lanes::mask_type changed(has_changed,
                                     std::experimental::element_aligned);
      for (unsigned int i = 0; i < 6; ++i)
        points.state[i] = choose(changed, returned[i], e[i]);
      return tau;
    }

    PrincipalTangent
    linearize(const MaterialLanes        &points,
              const std::array<Lanes, 3> &eps) const
    {
      PrincipalTangent tangent;
      const Lanes      volume = determinant(points.increment);
      for (unsigned int a = 0; a < 3; ++a)
        {
          tangent.stress[a] = 0.;
          tangent.moduli[a].fill(0.);
          tangent.secants[a] = 0.;
        }
      for (unsigned int lane = 0; lane < points.count; ++lane)
        {
          const Principal strain{{eps[0][lane], eps[1][lane], eps[2][lane]}};
          const Principal dev           = deviator_of(strain);
          const CriticalStateStep trial = make_trial(volume[lane], strain);
          State                   state = state_of(points, lane);

          CriticalStateReturn end{trial.log_pressure, trial.q};
          end.pressure_by_volume = -1. / elastic.kappa;
          law().return_map(trial, state, end, true);
          // n_a = d eps_s / d eps_a for the strain eps_s = q / (3 G).
          const double eps_s = trial.q / (3. * elastic.shear);
          const double G     = elastic.shear,
                       secant =
                         2. * G * (trial.q > 0. ? end.q / trial.q : end.q_by_q),
                       pressure =
                         elastic.attraction * std::exp(end.log_pressure);
          Principal n{{0., 0., 0.}};
          for (unsigned int a = 0; a < 3 && eps_s > 0.; ++a)
            n[a] = 2. / 3. * dev[a] / eps_s;
          for (unsigned int a = 0; a < 3; ++a)
            {
              tangent.stress[a][lane] =
                mean_stress(end.log_pressure) + secant * dev[a];
              tangent.secants[a][lane] = secant;
              for (unsigned int b = 0; b < 3; ++b)
                tangent.moduli[a][b][lane] =
                  -pressure * (end.pressure_by_volume +
                               end.pressure_by_q * 3. * G * n[b]) +
                  secant * ((a == b ? 1. : 0.) - 1. / 3.) +
                  n[a] * (end.q_by_volume + 3. * G * end.q_by_q * n[b] -
                          1.5 * secant * n[b]);
            }
        }
      return tangent;
    }

  protected:
    using Base = ElastoplasticLaw<Law, PressureElasticity>;
    using Base::elastic;
    using Base::law;
    using Base::plastic_strain;
    using Base::work;
    static constexpr unsigned int size = Base::more, void_ratio = size + 1,
                                  more = size + 2;

    double ratio             = 1.2;
    double overconsolidation = 1.;

    /// Void ratios are given at this pressure, Pa.
    static constexpr double reference_pressure = 1000.;

    /// Return ln(P / reference_pressure) from ln(P / a).
    double
    log_of_reference(const double log_pressure) const
    {
      return log_pressure + std::log(elastic.attraction / reference_pressure);
    }

  private:
    static Principal
    deviator_of(const Principal &eps)
    {
      const double mean = (eps[0] + eps[1] + eps[2]) / 3.;
      return {{eps[0] - mean, eps[1] - mean, eps[2] - mean}};
    }

    static double
    shear_strain(const Principal &dev)
    {
      return std::sqrt(2. / 3. *
                       (dev[0] * dev[0] + dev[1] * dev[1] + dev[2] * dev[2]));
    }

    CriticalStateStep
    make_trial(const double volume_ratio, const Principal &eps) const
    {
      return {-(eps[0] + eps[1] + eps[2]) / elastic.kappa,
              3. * elastic.shear * shear_strain(deviator_of(eps)),
              volume_ratio};
    }

    double
    mean_stress(const double log_pressure) const
    {
      return -elastic.attraction * std::expm1(log_pressure);
    }

    /// Return the state of the point in a lane. A state of zeros is replaced by
    /// the state of a stress-free point.
    State
    state_of(const MaterialLanes &points, const unsigned int lane) const
    {
      State state{};
      for (unsigned int k = 0; k < points.n_state; ++k)
        state[k] = points.state[k][lane];
      if (state[size] == 0.)
        law().set_initial(state, 0., 0.);
      return state;
    }
  };
} // namespace greville

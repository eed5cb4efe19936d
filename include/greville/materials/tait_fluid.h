// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/materials/hencky.h>
#include <greville/materials/material_lanes.h>
#include <greville/materials/parameter_checks.h>

namespace greville
{
  /**
   * A weakly compressible viscous fluid with Tait's equation of state (@ref
   * Cole1948 "Cole, 1948"; @ref Monaghan1994 "Monaghan, 1994"): with rho / rho0
   * = 1 / J
   *   p = B (J^-gamma - 1), B = rho0 c^2 / gamma, gamma = 7,
   *   sigma = (-p + zeta tr(d)) 1 + 2 eta dev(d), d = sym(f - 1) / dt,
   *   W = B ((J^(1 - gamma) - 1) / (gamma - 1) + J - 1),
   *   D = D + dt J (2 eta dev(d) : dev(d) + zeta tr(d)^2).
   * d is the rate of deformation that is power-conjugate to the internal forces
   * of an explicit step. It is objective for velocities (a spin causes no
   * stress), but not for an increment f that is a finite rotation.
   *
   * Without "Allow tension", a fluid with J > 1 has torn: p, zeta and W are
   * zero, but eta dev(d) remains. The wave modulus is -J dp / dJ = B gamma
   * J^-gamma, also in a torn fluid.
   *
   * Parameters: "Sound speed" c, m/s, at J = 1, "Bulk viscosity" zeta,
   * Pa s, "Allow tension". State: the dissipated energy D per
   * volume of the stress-free state, J / m^3.
   *
   * initialize() throws dealii::ExcMessage for shear stress, for tension that
   * is not allowed, and for p <= -B.
   *
   * A @p Law has
   *   static constexpr const char *name;
   *   double viscosity(double square) const,
   * eta (Pa s) for the @p square of the shear rate 2 dev(d) : dev(d), 1/s^2;
   *   double viscosity_slope(double square) const,
   * the derivative of eta, which may be singular at 0, but less than 1 /
   * square; and
   *   double largest_viscosity() const.
   */
  template <typename Law>
  class TaitFluid : public LanesMaterial
  {
  public:
    void
    declare(dealii::ParameterHandler &prm) override
    {
      Material::declare(prm);
      add_parameter(prm, "Sound speed", sound_speed, positive())(
        "Speed of sound in the stress-free fluid. Unit: m / s.");
      using dealii::Patterns::Double;
      add_parameter(prm, "Bulk viscosity", bulk_viscosity, Double(0.))(
        "Viscosity of changes of volume, often artificial. Unit: Pa s.");
      add_parameter(prm, "Allow tension", allow_tension)(
        "Allow negative pressure. If false, an expanded fluid has no "
        "pressure.");
    }

    bool
    spreads() const override
    {
      return true;
    }

    void
    reinit(const std::string &) override
    {
      B = this->density * sound_speed * sound_speed / exponent;
    }

    std::vector<std::string>
    state_names() const override
    {
      return {"dissipation"};
    }

    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      const double p = -trace(stress) / 3.;
      check_stress(deviator(stress).norm() <= 1e-12 * stress.norm(),
                   Law::name,
                   stress,
                   "a fluid at rest has no shear stress");
      check_stress(p >= 0. || allow_tension,
                   Law::name,
                   stress,
                   "tension is not allowed");
      check_stress(p > -B, Law::name, stress, [&]() {
        return "the tension has to be smaller than rho0 c^2 / gamma = " +
               text_of(B) + " Pa";
      });
      const double log_J = -std::log1p(p / B) / exponent;
      point.J            = std::exp(log_J);
      point.F            = 0.;
      for (unsigned int i = 0; i < 3; ++i)
        point.F[i][i] = std::exp(log_J / 3.);
      point.stress       = stress;
      point.wave_modulus = exponent * (B + p);
      point.state.first.fill(0.);
    }

    void
    update_lanes(MaterialLanes &points) const override
    {
      const Flow  flow(points);
      const Lanes ratio =
        exp_less_one(Lanes(-exponent * log_of_one_plus(points.J - 1.)));
      const Lanes::mask_type torn     = is_torn(points);
      const Lanes            pressure = choose(torn, Lanes(0.), B * ratio);
      points.wave_modulus             = B * exponent * (1. + ratio);

      Lanes eta;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        eta[lane] = law().viscosity(flow.square[lane]);
      const Lanes zeta = choose(torn, Lanes(0.), Lanes(bulk_viscosity));
      const Lanes mean = zeta * flow.rate - pressure;
      for (unsigned int i = 0; i < 3; ++i)
        {
          points.stress[i]     = mean + 2. * eta * flow.d[i];
          points.stress[i + 3] = 2. * eta * flow.d[i + 3];
        }
      points.state[0] += points.dt * points.J *
                         (eta * flow.square + zeta * flow.rate * flow.rate);
    }

    /// With df = l f: d(d)_ij / d l_kl = (delta_ik f_lj + delta_jk f_li) / (2
    /// dt).
    void
    tangent_lanes(const MaterialLanes &points,
                  TangentLanes        &D,
                  const unsigned int   dim) const override
    {
      const std::array<Lanes, 9> &f = points.increment;
      const Flow                  flow(points);
      const Lanes::mask_type      torn = is_torn(points);
      const Lanes                 modulus =
        choose(torn,
               Lanes(0.),
               B * exponent *
                 (1. + exp_less_one(
                         Lanes(-exponent * log_of_one_plus(points.J - 1.)))));
      Lanes eta, slope;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          const double square = flow.square[lane];
          eta[lane]           = flow.inverse_dt * law().viscosity(square);
          slope[lane] = 8. * flow.inverse_dt * law().viscosity_slope(square);
        }
      const Lanes zeta =
        choose(torn, Lanes(0.), Lanes(flow.inverse_dt * bulk_viscosity));
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
          {
            const Lanes *f_l    = &f[3 * l];
            Lanes        change = 0.;
            for (unsigned int j = 0; j < 3; ++j)
              change += flow.d[number_of_entry[k][j]] * f_l[j];
            change *= slope;
            Lanes mean = (zeta - 2. / 3. * eta) * f_l[k];
            if (k == l)
              mean += modulus;
            for (unsigned int e = 0; e < 6; ++e)
              {
                Lanes sum = change * flow.d[e];
                if (e < 3)
                  sum += mean;
                if (entry_rows[e] == k)
                  sum += eta * f_l[entry_columns[e]];
                if (entry_columns[e] == k)
                  sum += eta * f_l[entry_rows[e]];
                D[e][3 * k + l] = sum;
              }
          }
    }

    /// Return true without viscosity.
    bool
    has_symmetric_tangent() const override
    {
      return law().largest_viscosity() == 0. && bulk_viscosity == 0.;
    }

    EnergyLanes
    energies(const MaterialLanes &points) const override
    {
      const Lanes x = points.J - 1., log_J = log_of_one_plus(x);
      EnergyLanes result;
      result.strain = B * (x + exp_less_one(Lanes((1. - exponent) * log_J)) /
                                 (exponent - 1.));
      if (!allow_tension)
        result.strain = choose(points.J > 1., Lanes(0.), result.strain);
      result.dissipation = points.state[0];
      return result;
    }

    bool
    shares_volume() const override
    {
      return true;
    }

    double
    dissipation(const MaterialPoint &point) const override
    {
      return point.state[0];
    }

    Moduli
    moduli() const override
    {
      return {this->density * sound_speed * sound_speed,
              0.,
              law().largest_viscosity(),
              bulk_viscosity};
    }

  private:
    /// The rate of deformation, 1/s.
    struct Flow
    {
      explicit Flow(const MaterialLanes &points)
        : inverse_dt(points.dt > 0. ? 1. / points.dt : 0.)
      {
        const std::array<Lanes, 9> &f = points.increment;
        d                             = {{(f[0] - 1.) * inverse_dt,
                                          (f[4] - 1.) * inverse_dt,
                                          (f[8] - 1.) * inverse_dt,
                                          0.5 * (f[1] + f[3]) * inverse_dt,
                                          0.5 * (f[2] + f[6]) * inverse_dt,
                                          0.5 * (f[5] + f[7]) * inverse_dt}};
        rate                          = d[0] + d[1] + d[2];
        for (unsigned int i = 0; i < 3; ++i)
          d[i] -= rate / 3.;
        square = 2. * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) +
                 4. * (d[3] * d[3] + d[4] * d[4] + d[5] * d[5]);
      }

      double inverse_dt;
      /// The trace, the deviator, and its square 2 d : d.
      Lanes                rate;
      std::array<Lanes, 6> d;
      Lanes                square;
    };

    const Law &
    law() const
    {
      return static_cast<const Law &>(*this);
    }

    Lanes::mask_type
    is_torn(const MaterialLanes &points) const
    {
      return allow_tension ? Lanes::mask_type(false) : points.J > 1.;
    }

    static constexpr double exponent = 7.;

    double sound_speed    = 10.;
    double bulk_viscosity = 0.;
    bool   allow_tension  = false;
    double B              = 0.;
  };
} // namespace greville

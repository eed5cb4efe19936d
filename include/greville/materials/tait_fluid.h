// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_tait_fluid_h
#define greville_materials_tait_fluid_h

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
   * of an explicit step. It is objective in velocities (a spin adds no stress),
   * but not for an increment f that is a finite rotation.
   *
   * Without "Allow tension" a fluid with J > 1 has torn: p, zeta and W are
   * zero, eta dev(d) stays. The wave modulus is -J dp / dJ = B gamma J^-gamma,
   * also in a torn fluid.
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
      const std::array<Lanes, 9> &f = points.increment;
      const Lanes                 ratio =
        exp_less_one(Lanes(-exponent * log_of_one_plus(points.J - 1.)));
      const Lanes::mask_type torn =
        allow_tension ? Lanes::mask_type(false) : points.J > 1.;
      const Lanes pressure = choose(torn, Lanes(0.), B * ratio);
      points.wave_modulus  = B * exponent * (1. + ratio);

      const double inverse_dt = points.dt > 0. ? 1. / points.dt : 0.;
      Lanes        d[6]       = {(f[0] - 1.) * inverse_dt,
                                 (f[4] - 1.) * inverse_dt,
                                 (f[8] - 1.) * inverse_dt,
                                 0.5 * (f[1] + f[3]) * inverse_dt,
                                 0.5 * (f[2] + f[6]) * inverse_dt,
                                 0.5 * (f[5] + f[7]) * inverse_dt};
      const Lanes  rate       = d[0] + d[1] + d[2];
      for (unsigned int i = 0; i < 3; ++i)
        d[i] -= rate / 3.;
      const Lanes square = 2. * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) +
                           4. * (d[3] * d[3] + d[4] * d[4] + d[5] * d[5]);

      Lanes eta;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        eta[lane] = static_cast<const Law &>(*this).viscosity(square[lane]);
      const Lanes zeta = choose(torn, Lanes(0.), Lanes(bulk_viscosity));
      const Lanes mean = zeta * rate - pressure;
      for (unsigned int i = 0; i < 3; ++i)
        {
          points.stress[i]     = mean + 2. * eta * d[i];
          points.stress[i + 3] = 2. * eta * d[i + 3];
        }
      points.state[0] +=
        points.dt * points.J * (eta * square + zeta * rate * rate);
    }

    void
    tangents(const dealii::ArrayView<const MaterialPoint> &points,
             const dealii::ArrayView<MaterialTangent>     &result,
             const unsigned int                            dim) const override
    {
      AssertThrow(points.size() == result.size(),
                  dealii::ExcDimensionMismatch(points.size(), result.size()));
      for (std::size_t p = 0; p < points.size(); ++p)
        result[p] = tangent(points[p], dim);
    }

    /// Symmetric without viscosity.
    bool
    has_symmetric_tangent() const override
    {
      return static_cast<const Law &>(*this).largest_viscosity() == 0. &&
             bulk_viscosity == 0.;
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
              static_cast<const Law &>(*this).largest_viscosity(),
              bulk_viscosity};
    }

  private:
    /**
     * With df = l f: d(d)_ij / d l_kl = (delta_ik f_lj + delta_jk f_li) / (2
     * dt).
     */
    MaterialTangent
    tangent(const MaterialPoint &point, const unsigned int dim) const
    {
      const dealii::Tensor<2, 3> &f    = point.increment;
      const bool                  torn = point.J > 1. && !allow_tension;
      const double                modulus =
        torn ? 0. : B * exponent * std::exp(-exponent * std::log(point.J));
      const double inverse_dt = point.dt > 0. ? 1. / point.dt : 0.;
      const dealii::SymmetricTensor<2, 3> d = deviator(
        inverse_dt * (symmetrize(f) - dealii::unit_symmetric_tensor<3>()));
      const double square = 2. * (d * d);
      const Law   &law    = static_cast<const Law &>(*this);
      const double eta    = inverse_dt * law.viscosity(square),
                   slope  = 8. * inverse_dt * law.viscosity_slope(square),
                   zeta   = inverse_dt * (torn ? 0. : bulk_viscosity);

      MaterialTangent D;
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
          {
            const double mean =
              (zeta - 2. / 3. * eta) * f[l][k] + (k == l ? modulus : 0.);
            const double change =
              slope *
              (d[k][0] * f[l][0] + d[k][1] * f[l][1] + d[k][2] * f[l][2]);
            for (unsigned int i = 0; i < 3; ++i)
              {
                D[i][i][k][l] += mean;
                D[i][k][k][l] += eta * f[l][i];
                D[k][i][k][l] += eta * f[l][i];
                for (unsigned int j = 0; j < 3; ++j)
                  D[i][j][k][l] += change * d[i][j];
              }
          }
      return D;
    }

    static constexpr double exponent = 7.;

    double sound_speed    = 10.;
    double bulk_viscosity = 0.;
    bool   allow_tension  = false;
    double B              = 0.;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/averaged_contact.h>

#include <algorithm>
#include <cmath>

/// The force and tangent of a key by the sums over its points, for sources.
namespace greville::internal
{
  using namespace dealii;

  /// The sums of a key over points, which are added up over all processes.
  template <int dim>
  struct KeySums
  {
    double         weight[2] = {0., 0.}; // w^A, w^B
    double         gap = 0., start_pressure = 0., pore_pressure = 0.;
    Tensor<1, dim> normal, slip, motion[2];

    template <typename Action>
    void
    for_each(const Action &action)
    {
      action(weight[0]);
      action(weight[1]);
      action(gap);
      action(start_pressure);
      action(pore_pressure);
      for (unsigned int d = 0; d < dim; ++d)
        {
          action(normal[d]);
          action(slip[d]);
          action(motion[0][d]);
          action(motion[1][d]);
        }
    }
  };



  /// The contribution of a key to its points.
  template <int dim>
  struct KeyForce
  {
    Tensor<1, dim> force[2];    // per area, of both sides
    Tensor<1, dim> slip_change; // of the elastic slip
    double         is_active = 0.;
    double         state     = 0.; // a ContactState
    // Data for a ContactTangent: the key's number, w_k over the weights of
    // both sides, and D_k.
    double         number    = 0.;
    double         shares[2] = {0., 0.};
    Tensor<2, dim> stiffness;
    double         pressure = 0.; // for KeyMemory
    // The contribution of sliding to D_k, which is not symmetric. Stiffness for
    // preconditioners leaves it out.
    Tensor<2, dim> coupling;
    // The derivative of shear stress by mean pore pressure, over sum a_s psi_k.
    Tensor<1, dim> by_pore_pressure;
    // For a sliding key: the direction of shear stress, and D_k if it stuck.
    Tensor<1, dim> direction;
    Tensor<2, dim> sticking;

    template <typename Action>
    void
    for_each(const bool with_tangent, const Action &action)
    {
      for (unsigned int d = 0; d < dim; ++d)
        {
          action(force[0][d]);
          action(force[1][d]);
          action(slip_change[d]);
        }
      action(is_active);
      action(state);
      if (!with_tangent)
        return;
      action(number);
      action(shares[0]);
      action(shares[1]);
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int e = 0; e < dim; ++e)
          action(stiffness[d][e]);
    }
  };



  /// The contact pressure of a key, and minus its derivative by the gap.
  struct KeyPressure
  {
    double value, stiffness;
  };



  /// Return the pressure for a gap that has grown by @p motion in the part
  /// @p share of the step, and grows by @p change, from @p first to @p last, in
  /// the whole step.
  inline KeyPressure
  pressure_of_key(const ContactLaw &law,
                  const double      gap,
                  const double      first,
                  const double      last,
                  const double      change,
                  const double      motion,
                  const double      rate,
                  const double      share,
                  const double      given_pressure)
  {
    KeyPressure result{given_pressure - law.stiffness * gap -
                         law.viscosity * rate * motion,
                       law.stiffness + law.viscosity * rate};
    if (share < 1. && first * last < 0. && given_pressure == 0.)
      {
        // The fraction of the motion during which the gap is negative.
        const double depth  = std::abs(std::min(first, last));
        const double inside = std::abs(std::min(first, last) / change);
        result.value        = 0.5 * law.stiffness * inside * depth;
        result.stiffness *=
          last < 0. ? 2. * inside * (1. - 0.5 * inside) : inside * inside;
      }
    result.value = std::max(0., result.value);
    return result;
  }



  /// The shear of a key with its derivative. `slips` is also true at zero
  /// strength.
  template <int dim>
  struct KeyShear
  {
    Tensor<1, dim> stress, slip;
    Tensor<2, dim> stiffness;
    bool           slips;
  };



  /// Return the shear of a key after the elastic slip @p old and the motion
  /// @p step along the surface, and set the members of @p result that belong
  /// to sliding. @p pores is the weight of the sides with pores.
  template <int dim>
  KeyShear<dim>
  shear_of_key(const ContactLaw     &law,
               const KeyPressure    &pressure,
               const Tensor<1, dim> &n,
               const Tensor<1, dim> &old,
               const Tensor<1, dim> &step,
               const double          rate,
               const double          pores,
               const double          pore_pressure,
               const bool            with_tangent,
               KeyForce<dim>        &result)
  {
    const double         stiffness = law.shear_stiffness + law.viscosity * rate;
    const Tensor<2, dim> across    = outer_product(n, n);
    KeyShear<dim>        shear;
    shear.slip = old + step;
    shear.stress =
      -law.shear_stiffness * shear.slip - law.viscosity * rate * step;
    shear.stiffness =
      stiffness * (Tensor<2, dim>(unit_symmetric_tensor<dim>()) - across);
    const double speed   = rate * step.norm();
    double       largest = pressure.value > 0. ? law.adhesion : 0.;
    // Suction is limited by the contact pressure, so that the strength is
    // continuous as the pressure vanishes.
    const double mean_pore = pores > 0. ? pore_pressure / pores : 0.;
    const bool   is_capped = mean_pore < -pressure.value;
    const double effective = is_capped
                               ? 2. * pressure.value
                               : std::max(0., pressure.value - mean_pore);
    if (pressure.value > 0. && law.friction)
      largest += law.friction->strength(effective, speed);
    const double size = shear.stress.norm();
    shear.slips       = size > largest || largest == 0.;
    if (size > largest)
      {
        const Tensor<1, dim> direction = shear.stress / size;
        result.direction               = direction;
        result.sticking = shear.stiffness + pressure.stiffness * across;
        shear.stiffness -= stiffness * outer_product(direction, direction);
        shear.stiffness *= largest / size;
        shear.stress *= largest / size;
        if (with_tangent && pressure.value > 0. && effective > 0. &&
            law.friction)
          {
            const FrictionLaw::Slopes slopes =
              law.friction->slopes(effective, speed);
            result.coupling = (is_capped ? 2. : 1.) * slopes.by_pressure *
                              pressure.stiffness * outer_product(direction, n);
            if (pores > 0. && !is_capped)
              result.by_pore_pressure = -slopes.by_pressure / pores * direction;
            if (speed > 0.)
              result.coupling -= slopes.by_speed * rate / step.norm() *
                                 outer_product(direction, step);
          }
        shear.slip = -shear.stress / law.shear_stiffness;
      }
    else if (largest == 0.)
      shear.stiffness = Tensor<2, dim>();
    return shear;
  }



  /// Return the force of a key, and add its area to @p area.
  template <int dim>
  KeyForce<dim>
  force_of_key(const ContactLaw   &law,
               const KeySums<dim> &sums,
               const double        dt,
               const double        given_pressure,
               const double        share,
               const bool          with_tangent,
               double             &area)
  {
    KeyForce<dim> result;
    const double  w[2] = {sums.weight[0],
                         law.has_two_sides ? sums.weight[1] : sums.weight[0]};
    if (!(w[0] > 0. && w[1] > 0.) || !(sums.normal.norm() > 0.))
      return result;
    const double all =
      law.has_two_sides && law.both_measure ? w[0] + w[1] : w[0];
    const double pores =
      (law.has_pores_on(0) ? w[0] : 0.) + (law.has_pores_on(1) ? w[1] : 0.);
    const double         weight = 2. * w[0] * w[1] / (w[0] + w[1]);
    const double         gap    = sums.gap / all;
    const Tensor<1, dim> n      = sums.normal / sums.normal.norm();
    const Tensor<1, dim> du     = sums.motion[0] / w[0] - sums.motion[1] / w[1];
    const double         rate   = dt > 0. ? 1. / dt : 0.;
    // The gaps at both ends of the step.
    const double change = du * n / share;
    const double first = gap - share * change, last = first + change;
    const double smallest_gap = share < 1. ? std::min(first, last) : gap;
    if (smallest_gap >= law.touching && given_pressure == 0.)
      return result;
    const KeyPressure pressure = pressure_of_key(
      law, gap, first, last, change, du * n, rate, share, given_pressure);
    if (smallest_gap >= 0. && pressure.value == 0.)
      {
        // At this kink, use the derivative of a closed key.
        if (gap >= law.touching)
          return result;
        result.shares[0]            = weight / w[0];
        result.shares[1]            = weight / w[1];
        const Tensor<2, dim> across = outer_product(n, n);
        result.stiffness            = law.stiffness * across;
        if (law.friction && law.friction->strength(1., 0.) > 0.)
          result.stiffness +=
            law.shear_stiffness *
            (Tensor<2, dim>(unit_symmetric_tensor<dim>()) - across);
        return result;
      }
    const auto along = [&](const Tensor<1, dim> &vector) {
      return vector - (vector * n) * n;
    };
    const Tensor<1, dim> mean  = sums.slip / all;
    const KeyShear<dim>  shear = shear_of_key(law,
                                             pressure,
                                             n,
                                             along(mean),
                                             along(du),
                                             rate,
                                             pores,
                                             sums.pore_pressure,
                                             with_tangent,
                                             result);
    const Tensor<1, dim> force = weight * (pressure.value * n + shear.stress);
    result.force[0]            = force / w[0];
    result.force[1]            = -force / w[1];
    result.slip_change         = shear.slip - mean;
    result.is_active           = 1.;
    result.pressure            = pressure.value;
    result.shares[0]           = weight / w[0];
    result.shares[1]           = weight / w[1];
    result.stiffness           = shear.stiffness;
    if (pressure.value > 0.)
      {
        result.stiffness += pressure.stiffness * outer_product(n, n);
        result.state =
          double(shear.slips ? ContactState::slip : ContactState::stick);
        area += weight;
      }
    return result;
  }
} // namespace greville::internal

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/materials/mohr_coulomb.h>

namespace greville
{
  using namespace dealii;

  void
  MohrCoulomb::declare(ParameterHandler &prm)
  {
    HenckyPlasticity<MohrCoulomb>::declare(prm);
    using Patterns::Double;
    prm.add_parameter("Cohesion",
                      cohesion,
                      "Peak cohesion, Kirchhoff stress. Unit: Pa.",
                      Double(0.));
    prm.add_parameter("Residual cohesion",
                      residual_cohesion,
                      "Cohesion after softening; negative: the peak. Unit: Pa.",
                      Double());
    prm.add_parameter("Friction angle",
                      friction_angle,
                      "Peak angle of internal friction. Unit: degrees.",
                      Double(0., 89.));
    prm.add_parameter(
      "Residual friction angle",
      residual_friction_angle,
      "Friction angle after softening; negative: the peak. Unit: degrees.",
      Double(-90., 89.));
    prm.add_parameter("Dilatancy angle",
                      dilatancy_angle,
                      "Angle of dilatancy, at most the residual friction "
                      "angle. Unit: degrees.",
                      Double(0., 89.));
    prm.add_parameter("Softening",
                      softening,
                      "How cohesion and friction angle fall.",
                      Patterns::Selection("linear|exponential"));
    prm.add_parameter(
      "Softening strain",
      softening_strain,
      "Equivalent plastic strain at which linear softening ends, or over "
      "which exponential softening falls by the factor e. Unit: none.",
      positive());
  }



  void
  MohrCoulomb::reinit(const std::string &section)
  {
    HenckyPlasticity<MohrCoulomb>::reinit(section);
    last_cohesion = residual_cohesion < 0. ? cohesion : residual_cohesion;
    last_angle =
      residual_friction_angle < 0. ? friction_angle : residual_friction_angle;
    check_parameter(last_cohesion <= cohesion,
                    section,
                    "Residual cohesion",
                    last_cohesion,
                    "at most the peak cohesion, which is " + to_text(cohesion));
    check_parameter(last_angle <= friction_angle,
                    section,
                    "Residual friction angle",
                    last_angle,
                    "at most the peak friction angle, which is " +
                      to_text(friction_angle));
    check_parameter(dilatancy_angle <= last_angle,
                    section,
                    "Dilatancy angle",
                    dilatancy_angle,
                    "at most the (residual) friction angle, which is " +
                      to_text(last_angle));
    check_parameter(last_cohesion > 0. || last_angle > 0.,
                    section,
                    "Residual cohesion",
                    last_cohesion,
                    "greater than 0 where the residual friction angle is 0");
    softens       = last_cohesion < cohesion || last_angle < friction_angle;
    exponential   = (softening == "exponential");
    sin_dilatancy = std::sin(dilatancy_angle * (numbers::PI / 180.));
    peak          = surface(cohesion, friction_angle);
  }
} // namespace greville

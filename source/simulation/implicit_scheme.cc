// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/implicit_scheme.h>

namespace greville
{
  using namespace dealii;

  void
  ImplicitParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Newmark beta",
                      beta,
                      "newmark: the share beta of the end of a step in the "
                      "displacement. Unit: none.",
                      Patterns::Double(1e-6, 1.));
    prm.add_parameter("Newmark gamma",
                      gamma,
                      "newmark: the share gamma of the end of a step in the "
                      "velocity; 0.5 is of second order, more damps. Unit: "
                      "none.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Spectral radius",
                      spectral_radius,
                      "generalized-alpha: the factor by which a step changes "
                      "the amplitude of the highest modes; 1 keeps them, 0 "
                      "removes them. Unit: none.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Smallest step",
                      smallest_step,
                      "A run ends where Newton's method fails with this "
                      "fraction of 'Time/Step'. Unit: none.",
                      Patterns::Double(1e-12, 1.));
    prm.add_parameter("Easy iterations",
                      easy_iterations,
                      "A step that was cut doubles after one with at most so "
                      "many iterations of Newton's method. Unit: iterations.",
                      Patterns::Integer(0));
    prm.add_parameter(
      "Filling threshold",
      filling,
      "The 'Scheme/Filling threshold' of implicit steps. Where points move "
      "through the grid, cells that are half full are better extended over: "
      "linear systems need fewer iterations. Negative: 0.55 in updated and 0.1 "
      "in total Lagrangian steps. Unit: none.",
      Patterns::Double(-1., 2.));
  }



  bool
  is_implicit_scheme(const std::string &name)
  {
    return name == "quasi-static" || name == "backward-euler" ||
           name == "newmark" || name == "generalized-alpha" ||
           name == "implicit-midpoint";
  }



  ImplicitScheme
  make_implicit_scheme(const std::string        &name,
                       const ImplicitParameters &parameters)
  {
    ImplicitScheme scheme;
    const auto     newmark = [&](const double beta, const double gamma) {
      scheme.alpha_u = scheme.alpha_v = 1. / beta;
      scheme.alpha_a                  = 0.5 / beta - 1.;
      scheme.gamma                    = gamma;
    };
    if (name == "quasi-static")
      scheme.is_static = true;
    else if (name == "backward-euler")
      scheme.alpha_u = scheme.alpha_v = 1.;
    else if (name == "newmark")
      newmark(parameters.beta, parameters.gamma);
    else if (name == "generalized-alpha")
      {
        const double rho = parameters.spectral_radius;
        scheme.alpha_m   = (2. * rho - 1.) / (rho + 1.);
        scheme.alpha_f   = rho / (rho + 1.);
        const double sum = 1. - scheme.alpha_m + scheme.alpha_f;
        newmark(0.25 * sum * sum, sum - 0.5);
        scheme.keeps_acceleration = true;
      }
    else if (name == "implicit-midpoint")
      {
        scheme.alpha_u = scheme.alpha_v = 2.;
        scheme.stress                   = StepStress::energy_consistent;
        scheme.keeps_held_momentum      = true;
        scheme.load_time                = 0.5;
      }
    else
      AssertThrow(false, ExcMessage("<" + name + "> is no implicit scheme."));
    return scheme;
  }
} // namespace greville

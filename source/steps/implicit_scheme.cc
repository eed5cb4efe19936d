// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/implicit_scheme.h>

namespace greville
{
  using namespace dealii;



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
      newmark(0.25, 0.5);
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

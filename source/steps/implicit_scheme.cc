// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/steps/implicit_scheme.h>

#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    void
    set_newmark(ImplicitScheme &scheme, const double beta, const double gamma)
    {
      scheme.alpha_u = scheme.alpha_v = 1. / beta;
      scheme.alpha_a                  = 0.5 / beta - 1.;
      scheme.gamma                    = gamma;
    }



    using SetScheme = void (*)(ImplicitScheme &, const ImplicitParameters &);

    const std::map<std::string, SetScheme> &
    schemes()
    {
      static const std::map<std::string, SetScheme> list = {
        {"quasi-static",
         [](ImplicitScheme &scheme, const auto &) { scheme.is_static = true; }},
        {"backward-euler",
         [](ImplicitScheme &scheme, const auto &) {
           scheme.alpha_u = scheme.alpha_v = 1.;
         }},
        {"newmark",
         [](ImplicitScheme &scheme, const auto &) {
           set_newmark(scheme, 0.25, 0.5);
         }},
        {"generalized-alpha",
         [](ImplicitScheme &scheme, const auto &parameters) {
           const double rho = parameters.spectral_radius;
           scheme.alpha_m   = (2. * rho - 1.) / (rho + 1.);
           scheme.alpha_f   = rho / (rho + 1.);
           const double sum = 1. - scheme.alpha_m + scheme.alpha_f;
           set_newmark(scheme, 0.25 * sum * sum, sum - 0.5);
           scheme.keeps_acceleration = true;
         }},
        {"implicit-midpoint", [](ImplicitScheme &scheme, const auto &) {
           scheme.alpha_u = scheme.alpha_v   = 2.;
           scheme.stress                     = StepStress::energy_consistent;
           scheme.keeps_constrained_momentum = true;
           scheme.load_time                  = 0.5;
         }}};
      return list;
    }
  } // namespace



  bool
  is_implicit_scheme(const std::string &name)
  {
    return schemes().count(name) == 1;
  }



  ImplicitScheme
  make_implicit_scheme(const std::string        &name,
                       const ImplicitParameters &parameters)
  {
    Require(is_implicit_scheme(name), "<" + name + "> is no implicit scheme.");
    ImplicitScheme scheme;
    schemes().at(name)(scheme, parameters);
    return scheme;
  }
} // namespace greville

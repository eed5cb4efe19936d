// SPDX-License-Identifier: LGPL-2.1-or-later

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



    void
    set_quasi_static(ImplicitScheme &scheme, const ImplicitParameters &)
    {
      scheme.is_static = true;
    }



    void
    set_backward_euler(ImplicitScheme &scheme, const ImplicitParameters &)
    {
      scheme.alpha_u = scheme.alpha_v = 1.;
    }



    void
    set_trapezoidal_rule(ImplicitScheme &scheme, const ImplicitParameters &)
    {
      set_newmark(scheme, 0.25, 0.5);
    }



    void
    set_generalized_alpha(ImplicitScheme           &scheme,
                          const ImplicitParameters &parameters)
    {
      const double rho = parameters.spectral_radius;
      scheme.alpha_m   = (2. * rho - 1.) / (rho + 1.);
      scheme.alpha_f   = rho / (rho + 1.);
      const double sum = 1. - scheme.alpha_m + scheme.alpha_f;
      set_newmark(scheme, 0.25 * sum * sum, sum - 0.5);
      scheme.keeps_acceleration = true;
    }



    void
    set_implicit_midpoint(ImplicitScheme &scheme, const ImplicitParameters &)
    {
      scheme.alpha_u = scheme.alpha_v   = 2.;
      scheme.stress                     = StepStress::energy_consistent;
      scheme.keeps_constrained_momentum = true;
      scheme.load_time                  = 0.5;
    }



    using SetScheme = void (*)(ImplicitScheme &, const ImplicitParameters &);

    const std::map<std::string, SetScheme> &
    schemes()
    {
      static const std::map<std::string, SetScheme> list = {
        {"quasi-static", set_quasi_static},
        {"backward-euler", set_backward_euler},
        {"newmark", set_trapezoidal_rule},
        {"generalized-alpha", set_generalized_alpha},
        {"implicit-midpoint", set_implicit_midpoint}};
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
    AssertThrow(is_implicit_scheme(name),
                ExcMessage("<" + name + "> is no implicit scheme."));
    ImplicitScheme scheme;
    schemes().at(name)(scheme, parameters);
    return scheme;
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/explicit_schemes.h>
#include <greville/steps/implicit_steps.h>

#include <utility>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    struct Entry
    {
      std::string             name;
      MakeTimeIntegrator<dim> make;
      bool                    is_explicit = false;
    };

    template <int dim, typename Scheme>
    Entry<dim>
    explicit_steps(const std::string &name)
    {
      return {name,
              [](const IntegratorParts<dim> &parts) {
                return std::make_unique<Scheme>(parts);
              },
              true};
    }

    template <int dim>
    Entry<dim>
    implicit_steps(const std::string &name)
    {
      return {name, [name](const IntegratorParts<dim> &parts) {
                return std::make_unique<ImplicitSteps<dim>>(name, parts);
              }};
    }

    // All integrators, one line each.
    template <int dim>
    std::vector<Entry<dim>> &
    integrators()
    {
      static std::vector<Entry<dim>> list = {
        explicit_steps<dim, USL<dim>>("USL"),
        explicit_steps<dim, MUSL<dim>>("MUSL"),
        implicit_steps<dim>("quasi-static"),
        implicit_steps<dim>("backward-euler"),
        implicit_steps<dim>("newmark"),
        implicit_steps<dim>("generalized-alpha"),
        implicit_steps<dim>("implicit-midpoint")};
      return list;
    }
  } // namespace



  std::string
  time_integrator_names()
  {
    std::string names;
    const auto  add = [&](const std::string &name) {
      if (("|" + names + "|").find("|" + name + "|") == std::string::npos)
        names += (names.empty() ? "" : "|") + name;
    };
    for (const auto &entry : integrators<2>())
      add(entry.name);
    for (const auto &entry : integrators<3>())
      add(entry.name);
    return names;
  }



  bool
  is_explicit_scheme(const std::string &name)
  {
    for (const auto &entry : integrators<2>())
      if (entry.name == name)
        return entry.is_explicit;
    return false;
  }



  template <int dim>
  void
  add_time_integrator(const std::string             &name,
                      const MakeTimeIntegrator<dim> &make)
  {
    integrators<dim>().push_back({name, make});
  }



  template <int dim>
  std::unique_ptr<TimeIntegrator<dim>>
  make_time_integrator(const std::string          &name,
                       const IntegratorParts<dim> &parts)
  {
    for (const Entry<dim> &entry : integrators<dim>())
      if (entry.name == name)
        return entry.make(parts);
    Require(false,
            "'Scheme/Stress update' = <" + name + "> is none of " +
              time_integrator_names() + ".");
    return nullptr;
  }



  GREVILLE_INSTANTIATE(add_time_integrator);
  GREVILLE_INSTANTIATE(make_time_integrator);
} // namespace greville

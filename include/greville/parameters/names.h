// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/parameters.h>

#include <string>
#include <vector>

namespace greville
{
  // Names that parameters allow, separated by '|'.

  /// Return "auto" and the names for make_grid_mass(), separated by '|'.
  std::string
  mass_names();

  /// Throw dealii::ExcMessage with the name of the @p parameter if @p name is
  /// neither "auto" nor a name for make_grid_mass().
  void
  check_mass_name(const std::string &name, const std::string &parameter);

  /// A function that throws dealii::ExcMessage with the reason if a @p feature,
  /// such as "'Scheme/Functions' = domains", does not support a parameter.
  struct Refusal
  {
    void
    operator()(const bool         wrong,
               const std::string &parameter,
               const std::string &why) const;

    std::string feature;
  };

  /// The steps and walls that support a mass.
  struct MassSupport
  {
    bool friction_walls, affine, domains, implicit_steps, explicit_water;
  };

  /// Return the support of a mass, whose name is not "auto".
  const MassSupport &
  support_of_mass(const std::string &name);

  /// Return the masses with this support as words, such as "lumped or fmpm-K".
  std::string
  masses_with(const bool MassSupport::*support);

  std::vector<FormerParameter>
  former_parameters();

  /// Return all time integrators, including those of add_time_integrator().
  /// Defined beside their list, in a part that uses parameters.
  std::string
  time_integrator_names();

  /// Return whether this is one of the library's explicit time integrators.
  /// Defined beside their list.
  bool
  is_explicit_scheme(const std::string &name);

  /// Return whether make_implicit_scheme() has this name. Defined beside it.
  bool
  is_implicit_scheme(const std::string &name);
} // namespace greville

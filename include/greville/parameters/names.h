// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_parameters_names_h
#define greville_parameters_names_h

#include <string>

namespace greville
{
  // The names that parameters allow, separated by '|'.

  /**
   * "auto" and the names that make_grid_mass() takes, separated by '|'.
   */
  std::string
  mass_names();

  /**
   * Throws dealii::ExcMessage, which names the @p parameter, for a name that is
   * neither "auto" nor one that make_grid_mass() takes.
   */
  void
  check_mass_name(const std::string &name, const std::string &parameter);

  /**
   * The solvers of the consistent mass.
   */
  std::string
  mass_solver_methods();

  /**
   * All time integrators, with those of add_time_integrator(). Defined beside
   * their list, in a part that uses parameters.
   */
  std::string
  time_integrator_names();

  /**
   * Whether it is one of the library's explicit time integrators. Defined
   * beside their list.
   */
  bool
  is_explicit_scheme(const std::string &name);

  /**
   * Whether make_implicit_scheme() knows the name. Defined there.
   */
  bool
  is_implicit_scheme(const std::string &name);
} // namespace greville

#endif

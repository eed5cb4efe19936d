// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_state_names_h
#define greville_materials_state_names_h

#include <string>
#include <vector>

namespace greville
{
  /**
   * Return whether a text is a name: of letters, digits and _, without a digit
   * at the beginning.
   */
  bool
  is_state_name(const std::string &text);

  /**
   * Return whether other numbers or fields of points have this name, or the one
   * of a component: "stress_xy".
   */
  bool
  is_taken_by_points(const std::string &text);

  /**
   * Throw dealii::ExcMessage if history variables of the law of the section
   * @p section cannot be fields of points with these @p names.
   */
  void
  check_state_names(const std::vector<std::string> &names,
                    const std::string              &section);
} // namespace greville

#endif

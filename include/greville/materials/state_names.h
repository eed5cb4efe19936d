// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <string>
#include <vector>

namespace greville
{
  /// Return whether a text is a valid name: letters, digits and _, not
  /// beginning with a digit.
  bool
  is_state_name(const std::string &text);

  /// Return whether another number or field of points has this name, or a
  /// component with this name such as "stress_xy".
  bool
  is_taken_by_points(const std::string &text);

  /// Throw dealii::ExcMessage if a history variable of the law in @p section
  /// cannot be a field of points under its name.
  void
  check_state_names(const std::vector<std::string> &names,
                    const std::string              &section);
} // namespace greville

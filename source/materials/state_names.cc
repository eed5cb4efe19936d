// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/materials/state_names.h>

#include <algorithm>
#include <cctype>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Names of other numbers and fields of points.
    const auto taken = Utilities::split_string_list(
      "position, velocity, mass, volume0, J, stress, volume, wave_modulus, F, "
      "reference, id, affine, load, initial_F, projected_J, domain, size, "
      "displacement, density, pressure, von_mises, dissipation, body, process, "
      "x, y, z");
  } // namespace



  bool
  is_state_name(const std::string &text)
  {
    return !text.empty() && !std::isdigit((unsigned char)(text[0])) &&
           std::all_of(text.begin(), text.end(), [](const unsigned char c) {
             return std::isalnum(c) || c == '_';
           });
  }



  bool
  is_taken_by_points(const std::string &text)
  {
    const std::size_t last = text.rfind('_');
    const bool        is_component =
      last != std::string::npos && (last > 1 || text[0] == 'F') &&
      text.find_first_not_of("xyz0123456789", last + 1) == std::string::npos;
    return contains(taken, text) ||
           (is_component && contains(taken, text.substr(0, last)));
  }



  void
  check_state_names(const std::vector<std::string> &names,
                    const std::string              &section)
  {
    for (const std::string &name : names)
      {
        Require(is_state_name(name),
                "The law of '" + section + "' has a history variable <" + name +
                  ">; its name has to consist of letters, digits and _.");
        // Laws store "dissipation" as a history variable.
        Require(!is_taken_by_points(name) || name == "dissipation",
                "The law of '" + section + "' has a history variable <" + name +
                  ">, but all points have a variable of this name.");
        Require(std::count(names.begin(), names.end(), name) == 1,
                "The law of '" + section + "' has the history variable <" +
                  name + "> twice.");
      }
  }
} // namespace greville

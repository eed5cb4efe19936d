// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_source_base_formula_names_h
#define greville_source_base_formula_names_h

#include <algorithm>
#include <string>
#include <vector>

namespace greville
{
  namespace internal
  {
    /**
     * The variables of named formulas.
     */
    inline const std::vector<std::string> &
    variables_of_names()
    {
      static const std::vector<std::string> result = {
        "x", "y", "z", "X", "Y", "Z", "t"};
      return result;
    }

    inline bool
    contains_name(const std::vector<std::string> &list, const std::string &name)
    {
      return std::find(list.begin(), list.end(), name) != list.end();
    }
  } // namespace internal
} // namespace greville

#endif

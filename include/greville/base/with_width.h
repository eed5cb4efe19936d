// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_with_width_h
#define greville_base_with_width_h

#include <deal.II/base/exceptions.h>

#include <type_traits>

namespace greville
{
  /**
   * Call an action with a number of columns (1, 2, 4 or 8) that the compiler
   * knows: action(std::integral_constant<int, width>()).
   */
  template <typename Action>
  void
  with_width(const unsigned int width, const Action &action)
  {
    switch (width)
      {
        case 1:
          return action(std::integral_constant<int, 1>());
        case 2:
          return action(std::integral_constant<int, 2>());
        case 4:
          return action(std::integral_constant<int, 4>());
        case 8:
          return action(std::integral_constant<int, 8>());
        default:
          Assert(false, dealii::ExcInternalError());
      }
  }
} // namespace greville

#endif

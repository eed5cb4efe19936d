// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/exceptions.h>

#include <type_traits>

namespace greville
{
  /// Call an action with a number, one of @p numbers, as a compile-time
  /// constant: action(std::integral_constant<int, number>()). Returns whether
  /// the number is one of @p numbers.
  template <int... numbers, typename Action>
  bool
  with_one_of(const int number, const Action &action)
  {
    return ((number == numbers &&
             (action(std::integral_constant<int, numbers>()), true)) ||
            ...);
  }

  /// The largest number of columns of with_width().
  constexpr unsigned int max_width = 8;

  /// Call an action with a number of columns as a constant.
  template <typename Action>
  void
  with_width(const unsigned int width, const Action &action)
  {
    const bool is_known = with_one_of<1, 2, 3, 4, 8>(width, action);
    AssertThrow(is_known, dealii::ExcInternalError());
  }

  /// Call an action with the number p + 1 of functions of an order p per
  /// direction as a constant.
  template <typename Action>
  void
  with_order(const unsigned int degree, const Action &action)
  {
    const bool is_known = with_one_of<2, 3, 4, 5, 6>(degree + 1, action);
    AssertThrow(is_known, dealii::ExcInternalError());
  }
} // namespace greville

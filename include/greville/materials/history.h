// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <array>
#include <vector>

namespace greville
{
  /// The history variables of one point, or of several if Number is Lanes. The
  /// first numbers are stored in the object, so that laws with a short history
  /// never allocate memory.
  template <typename Number>
  struct History
  {
    static constexpr unsigned int n_first = 12;

    /// Resize to @p n numbers. Numbers after the first n_first become zero.
    void
    resize(const unsigned int n)
    {
      if (n > n_first)
        more.resize(n - n_first);
    }

    Number &
    operator[](const unsigned int k)
    {
      return k < n_first ? first[k] : more[k - n_first];
    }

    const Number &
    operator[](const unsigned int k) const
    {
      return k < n_first ? first[k] : more[k - n_first];
    }

    std::array<Number, n_first> first;
    std::vector<Number>         more;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_history_h
#define greville_materials_history_h

#include <array>
#include <vector>

namespace greville
{
  /**
   * The history of one point, or of several (Number is Lanes), of any length:
   * the first numbers lie in the object, so that laws with a short history
   * never allocate memory.
   */
  template <typename Number>
  struct History
  {
    static constexpr unsigned int n_first = 12;

    /**
     * Make room for @p n numbers; all are zero behind the first n_first.
     */
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

#endif

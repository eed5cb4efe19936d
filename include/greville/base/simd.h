// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_simd_h
#define greville_base_simd_h

#include <experimental/simd>

namespace greville
{
  /**
   * A native vector of doubles. (The VectorizedArray of a deal.II that was
   * compiled for any machine, as distributions do, holds one double only.) To
   * be included in sources, not in headers.
   */
  using Simd = std::experimental::native_simd<double>;

  constexpr unsigned int simd_width = Simd::size();

  inline Simd
  load(const double *address)
  {
    return Simd(address, std::experimental::element_aligned);
  }

  inline void
  store(const Simd &value, double *address)
  {
    value.copy_to(address, std::experimental::element_aligned);
  }
} // namespace greville

#endif

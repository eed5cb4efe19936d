// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <experimental/simd>

// With clang 14 and libstdc++ 12, where(mask, v) = x leaves v unchanged.
#if defined(__clang__) && defined(__AVX512F__)
#  error "With clang, AVX-512 gives wrong results: add -mno-avx512f."
#endif

namespace greville
{
  /// A vector of @p n numbers, in one register if the machine has registers of
  /// this width. (The VectorizedArray of a deal.II that was compiled for
  /// generic machines, as in distributions, holds one double only.)
  template <typename Number, int n>
  using FixedSimd =
    std::experimental::simd<Number,
                            std::experimental::simd_abi::deduce_t<Number, n>>;

  /// A vector of as many doubles as a register of the machine holds.
  using NativeSimd = std::experimental::native_simd<double>;

  constexpr unsigned int native_simd_width = NativeSimd::size();

  template <typename Vector, typename Number>
  Vector
  load(const Number *address)
  {
    return Vector(address, std::experimental::element_aligned);
  }

  template <typename Number, typename Abi>
  void
  store(const std::experimental::simd<Number, Abi> &value, Number *address)
  {
    value.copy_to(address, std::experimental::element_aligned);
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <cstdint>

namespace greville
{
  /// The finalizer of MurmurHash3: a bijection of 64 bits that spreads each bit
  /// over all of them, so that different sets of numbers have different sums,
  /// except by chance.
  inline std::uint64_t
  mixed_bits(std::uint64_t x)
  {
    x ^= x >> 33;
    x *= 0xff51afd7ed558ccdull;
    x ^= x >> 33;
    x *= 0xc4ceb9fe1a85ec53ull;
    return x ^ (x >> 33);
  }
} // namespace greville

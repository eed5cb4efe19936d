// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace greville
{
  /// An array of zeros, aligned to 64 bytes, whose pages the system provides
  /// when they are first written: untouched entries use no memory.
  template <typename Number>
  class ZeroedArray
  {
  public:
    ZeroedArray() = default;

    explicit ZeroedArray(const std::size_t n)
      : memory(std::calloc(n * sizeof(Number) + alignment, 1), &std::free)
    {
      if (!memory)
        throw std::bad_alloc();
      const auto address = reinterpret_cast<std::uintptr_t>(memory.get());
      values = reinterpret_cast<Number *>((address + alignment - 1) /
                                          alignment * alignment);
    }

    Number *
    data() const
    {
      return values;
    }

    Number &
    operator[](const std::size_t i) const
    {
      return values[i];
    }

  private:
    static constexpr std::size_t alignment = 64;

    std::unique_ptr<void, void (*)(void *)> memory{nullptr, &std::free};
    Number                                 *values = nullptr;
  };
} // namespace greville

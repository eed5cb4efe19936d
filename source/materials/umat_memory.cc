// SPDX-License-Identifier: LGPL-2.1-or-later


#include <greville/base/errors.h>
#include <greville/materials/umat_memory.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <sys/mman.h>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // A quiet NaN.
    constexpr std::uint64_t guard_mark = 0x7ff8475245564c4cULL;

    // The sizes of the pages before and behind the arguments, in bytes.
    constexpr std::size_t bytes_before = 1 << 16, bytes_behind = 1 << 22;

    constexpr const char *array_names[] = {
      "PROPS",  "CMNAME", "PREDEF", "DPRED",  "DTEMP",  "KSTEP",  "STRAN",
      "DSTRAN", "TIME",   "COORDS", "DROT",   "DFGRD0", "DFGRD1", "DTIME",
      "DDSDDT", "DRPLDE", "SCD",    "STRESS", "DDSDDE", "STATEV"};



    std::uint64_t
    bits_of(const double *number)
    {
      std::uint64_t bits;
      std::memcpy(&bits, number, sizeof(bits));
      return bits;
    }
  } // namespace



  void
  UmatMemory::reinit(const std::vector<double> &given_properties,
                     const std::string         &name,
                     const double               length,
                     const unsigned int         n_state_variables)
  {
    properties     = given_properties;
    padded_name    = name;
    element_length = length;
    nstatv         = n_state_variables;
    ntens          = 0;
  }



  void
  UmatMemory::lay_out(const unsigned int n)
  {
    ntens        = n;
    size         = {};
    size[props]  = properties.size();
    size[cmname] = padded_name.size() / sizeof(double);
    size[predef] = size[dpred] = size[dtime] = 1;
    size[constants] = size[coords] = 3;
    size[integers]                 = 14 * sizeof(int) / sizeof(double);
    size[time]                     = 2;
    size[results]                  = 6;
    size[statev]                   = nstatv;
    size[ddsdde]                   = n * n;
    for (const Array array : {stran, dstran, ddsddt, drplde, stress})
      size[array] = n;
    for (const Array array : {drot, dfgrd0, dfgrd1})
      size[array] = 9;

    unsigned int end = n_guards;
    for (unsigned int array = 0; array < n_arrays; ++array)
      {
        begin[array]  = end;
        guards[array] = end + size[array];
        end           = guards[array] + n_guards;
      }

    const std::size_t page    = sysconf(_SC_PAGESIZE);
    const std::size_t n_bytes = end * sizeof(double);
    const std::size_t used    = (n_bytes + page - 1) / page * page;
    const std::size_t all     = bytes_before + used + bytes_behind;
    void *const       memory  = mmap(nullptr,
                              all,
                              PROT_NONE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
                              -1,
                              0);
    if (memory == MAP_FAILED)
      throw std::bad_alloc();
    pages       = {memory, [all](void *address) { munmap(address, all); }};
    n_all_bytes = all;
    char *const first = static_cast<char *>(memory) + bytes_before;
    if (mprotect(first, used, PROT_READ | PROT_WRITE) != 0)
      throw std::bad_alloc();
    // The last guard ends at the end of the pages.
    data = reinterpret_cast<double *>(first + used - n_bytes);

    std::fill_n(data, end, 0.);
    const auto set_guard = [&](double *const guard) {
      for (unsigned int k = 0; k < n_guards; ++k)
        std::memcpy(guard + k, &guard_mark, sizeof(guard_mark));
    };
    set_guard(data);
    for (const unsigned int guard : guards)
      set_guard(data + guard);
    std::copy(properties.begin(), properties.end(), (*this)[props]);
    std::memcpy((*this)[cmname], padded_name.data(), padded_name.size());
    (*this)[constants][0] = element_length;
    std::array<int, 14> integer_values{
      {3, int(n) - 3, int(n), int(nstatv), int(properties.size())}};
    std::fill_n(integer_values.begin() + 5, 7, 1);
    std::memcpy((*this)[integers],
                integer_values.data(),
                sizeof(integer_values));
    image.assign(data, data + begin[stran]);
  }



  bool
  UmatMemory::is_intact() const
  {
    std::uint64_t       changed = 0;
    const double *const kept    = image.data();
    for (unsigned int k = 0; k < image.size(); ++k)
      changed |= bits_of(data + k) ^ bits_of(kept + k);
    // Compare four numbers at once.
    std::array<std::uint64_t, n_guards> bad = {};
    for (unsigned int array = stran; array < n_arrays; ++array)
      for (unsigned int k = 0; k < n_guards; ++k)
        bad[k] |= bits_of(data + guards[array] + k) ^ guard_mark;
    return (changed | bad[0] | bad[1] | bad[2] | bad[3]) == 0;
  }



  std::string
  UmatMemory::damage()
  {
    const auto is_changed = [&](const unsigned int at) {
      return bits_of(data + at) != guard_mark;
    };
    std::string result;
    if (is_changed(n_guards - 1))
      result = "has written before PROPS";
    for (unsigned int array = 0; array < n_arrays && result.empty(); ++array)
      {
        unsigned int first = 0;
        while (first < n_guards && !is_changed(guards[array] + first))
          ++first;
        if (first == n_guards)
          continue;
        // If only the end of the guard has changed, the UMAT has written before
        // the next array.
        if (first >= n_guards / 2 && array + 1 < n_arrays)
          result = std::string("has written before ") + array_names[array + 1];
        else
          {
            const unsigned int n = array == integers ? 4
                                   : array == cmname ? padded_name.size()
                                   : array == constants || array == results
                                     ? 1
                                     : size[array];
            result = std::string("has written beyond ") + array_names[array] +
                     ", which has " + std::to_string(n) +
                     (n == 1 ? " entry" : " entries");
          }
      }
    if (result.empty())
      {
        const auto differ = [&](const Array array) {
          return std::memcmp((*this)[array],
                             image.data() + begin[array],
                             size[array] * sizeof(double)) != 0;
        };
        result = "has changed " + std::string(differ(props)    ? "PROPS"
                                              : differ(cmname) ? "CMNAME"
                                              : differ(predef) ? "PREDEF"
                                              : differ(dpred)  ? "DPRED"
                                              : differ(constants)
                                                ? "CELENT, TEMP or DTEMP"
                                                : "an integer argument");
      }
    lay_out(ntens);
    return result;
  }



  bool
  UmatMemory::is_finite() const
  {
    // The results are contiguous, with guards of NaNs between them.
    constexpr std::uint64_t exponent = 0x7ff0000000000000ULL;
    const double *const     first    = data + begin[results];
    const unsigned int      n        = begin[statev] + nstatv - begin[results];
    std::uint64_t           n_bad    = 0;
    for (unsigned int k = 0; k < n; ++k)
      n_bad += (bits_of(first + k) & exponent) == exponent;
    return n_bad == 3 * n_guards;
  }



  std::string
  UmatMemory::not_finite() const
  {
    const auto find = [&](const Array array, const unsigned int first = 0) {
      const double *const numbers = data + begin[array];
      for (unsigned int k = first; k < size[array]; ++k)
        if (!std::isfinite(numbers[k]))
          return int(k);
      return -1;
    };
    constexpr const char *energies[] = {"SSE", "SPD", "SCD"};
    const auto            text = [&](const Array array, const unsigned int k) {
      return text_of(std::abs(data[begin[array] + k])) + " in " +
             (array == results ? energies[k - 3]
                                          : array_names[array] + std::string("("));
    };
    for (const Array array : {stress, statev})
      if (const int k = find(array); k >= 0)
        return text(array, k) + std::to_string(k + 1) + ")";
    if (const int k = find(ddsdde); k >= 0)
      return text(ddsdde, k) + std::to_string(k % ntens + 1) + "," +
             std::to_string(k / ntens + 1) + ")";
    if (const int k = find(results, 3); k >= 0)
      return text(results, k);
    return "";
  }



  bool
  UmatMemory::is_beyond(const void *address) const
  {
    const char *const first = static_cast<const char *>(pages.get());
    const char *const at    = static_cast<const char *>(address);
    return first != nullptr && at >= first && at < first + n_all_bytes;
  }
} // namespace greville

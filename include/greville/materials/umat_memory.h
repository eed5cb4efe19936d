// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /// The arguments of a UMAT in separate memory, with guards between them.
  /// Guards are marked NaNs, which change if a UMAT writes beyond an array, and
  /// spread if it reads beyond one. The pages before and after all arguments
  /// can be neither read nor written. STATEV is the last array, since laws most
  /// often get its length wrong.
  class UmatMemory
  {
  public:
    /// Arguments. Scalars of a kind share an array.
    enum Array
    {
      // A UMAT must not change these. Only KINC changes between calls.
      props,
      cmname,
      predef,
      dpred,
      constants, // CELENT, TEMP, DTEMP
      integers,  // NDI to KSTEP, in the order of lay_out()
                 // These arguments are written before each call.
      stran,
      dstran,
      time,
      coords,
      drot,
      dfgrd0,
      dfgrd1,
      dtime,
      // The UMAT writes these arguments.
      ddsddt,
      drplde,
      results, // RPL, DRPLDT, PNEWDT, SSE, SPD, SCD
      stress,
      ddsdde,
      statev,
      n_arrays
    };

    /// Set the values that all calls share. The name is CMNAME, padded to 80
    /// letters.
    void
    reinit(const std::vector<double> &properties,
           const std::string         &padded_name,
           const double               element_length,
           const unsigned int         n_state_variables);

    /// Reserve memory for NTENS = @p n.
    void
    prepare(const unsigned int n)
    {
      if (n != ntens)
        lay_out(n);
    }

    double *
    operator[](const Array array)
    {
      return data + begin[array];
    }

    void
    set_kinc(const int kinc)
    {
      for (double *const all : {data, image.data()})
        std::memcpy(reinterpret_cast<int *>(all + begin[integers]) + 9,
                    &kinc,
                    sizeof(kinc));
    }

    const char *
    name() const
    {
      return reinterpret_cast<const char *>(data + begin[cmname]);
    }

    const int *
    integer(const unsigned int k) const
    {
      return reinterpret_cast<const int *>(data + begin[integers]) + k;
    }

    /// Return whether a call has changed only its arguments.
    bool
    is_intact() const;

    /// Return the fault of a call, such as "has written beyond STATEV, which
    /// has 3 entries", and restore the memory.
    std::string
    damage();

    /// Return whether all results are finite, see not_finite().
    bool
    is_finite() const;

    /// Return the first entry of STRESS, DDSDDE, STATEV, SSE, SPD and SCD that
    /// is infinite or NaN, as in "nan in STATEV(2)", or an empty text.
    std::string
    not_finite() const;

    /// Return whether an @p address lies in the pages around the arguments.
    bool
    is_beyond(const void *address) const;

  private:
    static constexpr unsigned int n_guards = 4;

    void
    lay_out(const unsigned int n);

    std::vector<double> properties;
    std::string         padded_name;
    double              element_length = 1.;
    unsigned int        ntens = 0, nstatv = 0;
    // All pages, the position of the arguments in them, and for each array its
    // first number and its length.
    std::shared_ptr<void>              pages;
    std::size_t                        n_all_bytes = 0;
    double                            *data        = nullptr;
    std::array<unsigned int, n_arrays> begin, size;
    // The first numbers of the guards after the arrays; and a copy of the
    // arguments that a UMAT must not change, with their guards.
    std::array<unsigned int, n_arrays> guards;
    std::vector<double>                image;
  };
} // namespace greville

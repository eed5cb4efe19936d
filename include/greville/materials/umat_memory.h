// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_umat_memory_h
#define greville_materials_umat_memory_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * The arguments of a UMAT in memory of their own, with guards between them:
   * NaNs with a mark, which a UMAT changes that writes beyond an array, and
   * which it gets from reading beyond one. Before and behind all arguments
   * there are pages that may neither be read nor written; STATEV is the last
   * array, since it is the one whose length laws get wrong.
   */
  class UmatMemory
  {
  public:
    /// Scalars of a kind share an array.
    enum Array
    {
      // A UMAT has to leave these as they are. KINC alone changes between
      // calls.
      props,
      cmname,
      predef,
      dpred,
      constants, // CELENT, TEMP, DTEMP
      integers,  // NDI to KSTEP, in the order of lay_out()
                 // These are written before each call.
      stran,
      dstran,
      time,
      coords,
      drot,
      dfgrd0,
      dfgrd1,
      dtime,
      // The UMAT writes these.
      ddsddt,
      drplde,
      results, // RPL, DRPLDT, PNEWDT, SSE, SPD, SCD
      stress,
      ddsdde,
      statev,
      n_arrays
    };

    /**
     * Set what is the same in all calls. The name has 80 letters.
     */
    void
    reinit(const std::vector<double> &properties,
           const std::string         &padded_name,
           const double               element_length,
           const unsigned int         n_state_variables);

    /**
     * Make room for NTENS = @p n.
     */
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

    /**
     * Return whether a call has written no memory that it must not write.
     */
    bool
    is_intact() const;

    /**
     * Return the fault of such a call, such as "has written beyond STATEV,
     * which has 3 entries", and restore the memory.
     */
    std::string
    damage();

    /**
     * Return whether all results are finite. If not, not_finite() says whether
     * one of them has to be.
     */
    bool
    is_finite() const;

    /**
     * The first entry of STRESS, DDSDDE, STATEV, SSE, SPD and SCD that is
     * infinite or NaN, as in "nan in STATEV(2)", or nothing.
     */
    std::string
    not_finite() const;

    /**
     * Return whether an @p address lies in the pages around the arguments.
     */
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
    // All pages, where the arguments begin in them, the first numbers of
    // arrays, and their lengths.
    std::shared_ptr<void>              pages;
    std::size_t                        n_all_bytes = 0;
    double                            *data        = nullptr;
    std::array<unsigned int, n_arrays> begin, size;
    // The numbers at which the guards behind arrays begin, and what a UMAT has
    // to leave as it is, with its guards.
    std::array<unsigned int, n_arrays> guards;
    std::vector<double>                image;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <cstddef>

namespace greville
{
  // Routines that Abaqus supplies for UMATs, under their Fortran names. Tensors
  // have the order 11, 22, 33, 12, 13, 23, with the first ndi direct components
  // and nshr shears; shears of strains (lstr = 2) are twice the tensor entries,
  // shears of stresses (lstr = 1) are not.
  extern "C"
  {
    /// Compute the mean tr(s) / 3, and sqrt(3 / 2 dev(s) : dev(s)).
    void
    sinv_(const double *stress,
          double       *sinv1,
          double       *sinv2,
          const int    *ndi,
          const int    *nshr);

    /// Compute the three principal values, the largest first.
    void
    sprinc_(const double *s,
            double       *ps,
            const int    *lstr,
            const int    *ndi,
            const int    *nshr);

    /// Compute the principal values, and AN(k, i), component i of the direction
    /// of PS(k).
    void
    sprind_(const double *s,
            double       *ps,
            double       *an,
            const int    *lstr,
            const int    *ndi,
            const int    *nshr);

    /// Compute R S R^T; sprime may be s.
    void
    rotsig_(const double *s,
            const double *r,
            double       *sprime,
            const int    *lstr,
            const int    *ndi,
            const int    *nshr);

    /// End the step: throws dealii::ExcMessage.
    void
    xit_();

    /// Write a message with %I, %R and %S for the next entry of intv, realv and
    /// charv (8 characters each). If lop is 1 (information) or -1 (a warning),
    /// each text is written once to the error output; if lop is -2 or -3
    /// (errors), throws dealii::ExcMessage. The string lengths are hidden
    /// arguments of Fortran.
    void
    stdb_abqerr_(const int    *lop,
                 const char   *text,
                 const int    *intv,
                 const double *realv,
                 const char   *charv,
                 std::size_t   text_length,
                 std::size_t   charv_length);
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_umat_utilities_h
#define greville_materials_umat_utilities_h

#include <cstddef>

namespace greville
{
  // Routines that Abaqus supplies for UMATs, by the names that Fortran gives
  // them. Tensors are 11, 22, 33, 12, 13, 23, of which there are the first ndi
  // direct components and nshr shears; shears of strains (lstr = 2) are twice
  // those of the tensor, those of stresses (lstr = 1) are not.
  extern "C"
  {
    /// The mean tr(s) / 3, and sqrt(3 / 2 dev(s) : dev(s)).
    void
    sinv_(const double *stress,
          double       *sinv1,
          double       *sinv2,
          const int    *ndi,
          const int    *nshr);

    /// The three principal values, the largest first.
    void
    sprinc_(const double *s,
            double       *ps,
            const int    *lstr,
            const int    *ndi,
            const int    *nshr);

    /// Those, and AN(k, i), the component i of the direction of PS(k).
    void
    sprind_(const double *s,
            double       *ps,
            double       *an,
            const int    *lstr,
            const int    *ndi,
            const int    *nshr);

    /// R S R^T; sprime may be s.
    void
    rotsig_(const double *s,
            const double *r,
            double       *sprime,
            const int    *lstr,
            const int    *ndi,
            const int    *nshr);

    /// Throws dealii::ExcMessage: the step fails.
    void
    xit_();

    /// A message with %I, %R and %S for the next entry of intv, realv and charv
    /// (8 characters each): on the error output, once for each text, where lop
    /// is 1 (information) or -1 (a warning); with -2 and -3, errors, it throws
    /// dealii::ExcMessage. The lengths are the hidden ones of the two strings.
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

#endif

/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * The interface of a UMAT for C and C++: all arguments by reference, arrays
 * with the first index running fastest, and the length of cmname, which is
 * padded with blanks, at the end.
 */
#ifndef umat_h
#define umat_h

#include <stddef.h>

#ifdef __cplusplus
extern "C"
#endif
  void
  umat_(double       *stress,
        double       *statev,
        double       *ddsdde,
        double       *sse,
        double       *spd,
        double       *scd,
        double       *rpl,
        double       *ddsddt,
        double       *drplde,
        double       *drpldt,
        const double *stran,
        const double *dstran,
        const double *time,
        const double *dtime,
        const double *temp,
        const double *dtemp,
        const double *predef,
        const double *dpred,
        const char   *cmname,
        const int    *ndi,
        const int    *nshr,
        const int    *ntens,
        const int    *nstatv,
        const double *props,
        const int    *nprops,
        const double *coords,
        const double *drot,
        double       *pnewdt,
        const double *celent,
        const double *dfgrd0,
        const double *dfgrd1,
        const int    *noel,
        const int    *npt,
        const int    *layer,
        const int    *kspt,
        const int    *kstep,
        const int    *kinc,
        size_t        length);

#endif

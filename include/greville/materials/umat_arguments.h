/* SPDX-License-Identifier: LGPL-2.1-or-later */

#pragma once

#include <stddef.h>

/**
 * The arguments of an Abaqus UMAT, for C and C++ (in C++ with extern "C"):
 *   void umat_(GREVILLE_UMAT_ARGUMENTS) { ... }
 * All are passed by reference, as in Fortran. The first index of arrays runs
 * fastest. The last argument is the length of cmname, which is padded with
 * blanks.
 */
#define GREVILLE_UMAT_ARGUMENTS                                               \
  double *stress, double *statev, double *ddsdde, double *sse, double *spd,   \
    double *scd, double *rpl, double *ddsddt, double *drplde, double *drpldt, \
    const double *stran, const double *dstran, const double *time,            \
    const double *dtime, const double *temp, const double *dtemp,             \
    const double *predef, const double *dpred, const char *cmname,            \
    const int *ndi, const int *nshr, const int *ntens, const int *nstatv,     \
    const double *props, const int *nprops, const double *coords,             \
    const double *drot, double *pnewdt, const double *celent,                 \
    const double *dfgrd0, const double *dfgrd1, const int *noel,              \
    const int *npt, const int *layer, const int *kspt, const int *kstep,      \
    const int *kinc, size_t length

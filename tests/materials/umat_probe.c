/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * Notes in STATEV what it is given, for tests of the interface, and answers
 * with stress += E dstran, Poisson's ratio 0.
 * PROPS: E; the largest strain for which PNEWDT stays; whether DDSDDE is given.
 */
#include <greville/materials/umat_arguments.h>

#include <math.h>
#include <string.h>

void
umat_(GREVILLE_UMAT_ARGUMENTS)
{
  const int n = *ntens;
  double    size = 0., given[24] = {0.};
  int       is_padded = length == 80 && strncmp(cmname, "SAND ", 5) == 0;
  for (size_t i = 4; i < length; ++i)
    is_padded = is_padded && cmname[i] == ' ';
  for (int i = 0; i < n; ++i)
    {
      const double modulus = props[0] * (i < 3 ? 1. : 0.5);
      stress[i] += modulus * dstran[i];
      size = fmax(size, fabs(dstran[i]));
      for (int j = 0; j < n; ++j)
        ddsdde[i + n * j] = i == j && props[2] > 0. ? modulus : 0.;
      given[12 + i] = stran[i];
    }
  given[0]  = time[0];
  given[1]  = time[1];
  given[2]  = *dtime;
  given[3]  = coords[0];
  given[4]  = coords[1];
  given[5]  = coords[2];
  given[6]  = 100. * *ntens + 10. * *ndi + *nshr;
  given[7]  = *kinc;
  given[8]  = is_padded;
  given[9]  = *celent;
  given[10] = drot[1]; /* row 2, column 1 */
  given[11] = dfgrd0[3] + 10. * dfgrd1[3];
  given[18] = *nprops;
  /* The last five are sums, and the initial state stays in them. */
  memcpy(statev, given, 19 * sizeof(double));
  statev[19] += *dtime;
  statev[20] += dstran[0];
  for (int i = 21; i < *nstatv; ++i)
    statev[i] += 1e-3 * i * *dtime;
  if (size > props[1])
    *pnewdt = 0.25;
}

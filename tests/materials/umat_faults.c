/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * Hooke's law in increments, with faults.
 * PROPS: Young's modulus; the number of the fault, 0 for none; the time from which
 * on it has it, s. STATEV: one.
 */
#include <greville/materials/umat_arguments.h>

#include <math.h>
#include <stdlib.h>

static volatile int    zero = 0;
static volatile double sum  = 0.;

static double
fill_the_stack(const int n)
{
  volatile double room[1000];
  room[n % 1000] = n;
  return room[0] + fill_the_stack(n + 1) + room[n % 1000];
}

void
umat_(GREVILLE_UMAT_ARGUMENTS)
{
  const int n = *ntens;
  for (int i = 0; i < n; ++i)
    {
      const double modulus = props[0] * (i < 3 ? 1. : 0.5);
      stress[i] += modulus * dstran[i];
      for (int j = 0; j < n; ++j)
        ddsdde[i + n * j] = i == j ? modulus : 0.;
    }
  statev[0] += *dtime;
  if (time[1] < props[2])
    return;
  switch ((int)props[1])
    {
      /* Memory. */
      case 1: statev[*nstatv] = 1.; break;
      case 2: statev[-1] = 1.; break;
      case 3: stress[n] = 0.; break;
      case 4: ddsdde[n * n + 1] = 0.; break;
      case 5: ((double *)dstran)[n] = 0.; break;
      case 6: ((double *)dfgrd1)[9] = 0.; break;
      case 7: ((double *)props)[1] = 1e9; break;
      case 8: *(int *)ntens = 6 + n; break;
      case 9: ((int *)kstep)[4] = 1; break;
      case 10: ((char *)cmname)[0] = 'x'; break;
      case 11: ((double *)props)[-1] = 0.; break;
      case 12: ((double *)predef)[0] = 1.; break;
      case 13: ddsddt[n + 3] = 0.; break;
      case 14: *pnewdt = NAN; break;
      case 15: stress[1] = NAN; break;
      case 16: statev[0] = INFINITY; break;
      case 17: ddsdde[n + 2] = NAN; break;
      case 18: *spd = NAN; break;
      case 19: stress[0] += props[*nprops]; break;
      /* The end of the process. */
      case 20: exit(0);
      case 21: quick_exit(0);
      case 22: abort();
      case 23: *(int *)(size_t)zero = 1; break;
      case 24: statev[0] = 7 / zero; break;
      case 25: statev[100000] = 1.; break;
      case 26: sum = fill_the_stack(0); break;
      case 27:
        for (;;)
          sum += 1.;
    }
}

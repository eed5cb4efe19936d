/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * Hooke's law in increments, with faults.
 * PROPS: Young's modulus; the number of the fault, 0 for none; the time from which
 * on it has it, s. STATEV: one. Faults of the initializer are those of the command
 * line, which has "Properties=1e6, 40".
 */
#define _GNU_SOURCE
#include <greville/materials/umat_arguments.h>

#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static volatile int    zero = 0;
static volatile double sum  = 0.;

static double
fill_the_stack(const int n)
{
  volatile double room[1000];
  room[n % 1000] = n;
  return room[0] + fill_the_stack(n + 1) + room[n % 1000];
}

static void
change_numbers(void)
{
  feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
  fesetround(FE_DOWNWARD);
}

__attribute__((constructor)) static void
initialize(void)
{
  static char line[100000];
  FILE *const file = fopen("/proc/self/cmdline", "r");
  size_t      n    = file ? fread(line, 1, sizeof(line) - 1, file) : 0;
  for (size_t k = 0; k < n; ++k)
    if (line[k] == 0)
      line[k] = ' ';
  if (file)
    fclose(file);
  const char *const given = strstr(line, "Properties=1e6, ");
  switch (given ? atoi(given + strlen("Properties=1e6, ")) : 0)
    {
      case 40: exit(0);
      case 41: _exit(0);
      case 42: *(int *)(size_t)zero = 1; break;
      case 43: abort();
      case 44: change_numbers(); break;
    }
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
      case 28: _exit(0);
      case 29: raise(SIGTRAP); break;
      /* Memory of the program. */
      case 30:
        mprotect((void *)((size_t)stress / 4096 * 4096), 4096, PROT_READ);
        break;
      /* The rest of the process. */
      case 31:
        if (sum == 0.)
          fork();
        sum = 1.;
        break;
      case 32: change_numbers(); break;
    }
}

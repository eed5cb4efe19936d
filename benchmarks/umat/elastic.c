/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * Hooke's law from the strain increment, as in UMATs for small strains, in
 * Kirchhoff stresses: tau = J_0 sigma + lambda tr(d) 1 + 2 G d with the
 * logarithmic strain increment d = DSTRAN. It equals 'linear-elastic' if the
 * strain axes do not turn, and otherwise if d is small against 1.
 * PROPS: Young's modulus and Poisson's ratio. No STATEV.
 */
#include <greville/materials/umat_arguments.h>

static double
determinant(const double *F)
{
  return F[0] * (F[4] * F[8] - F[7] * F[5]) -
         F[3] * (F[1] * F[8] - F[7] * F[2]) +
         F[6] * (F[1] * F[5] - F[4] * F[2]);
}

void
umat_(GREVILLE_UMAT_ARGUMENTS)
{
  const int    n      = *ntens;
  const double G      = props[0] / (2. * (1. + props[1]));
  const double lambda = 2. * G * props[1] / (1. - 2. * props[1]);
  const double before = determinant(dfgrd0), J = determinant(dfgrd1);
  const double volume = dstran[0] + dstran[1] + dstran[2];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      ddsdde[i + n * j] =
        ((i < 3 && j < 3 ? lambda : 0.) + (i == j ? (i < 3 ? 2. : 1.) * G : 0.)) /
        J;
  for (int i = 0; i < n; ++i)
    stress[i] = (before * stress[i] + (i < 3 ? lambda * volume : 0.) +
                 (i < 3 ? 2. : 1.) * G * dstran[i]) /
                J;
}

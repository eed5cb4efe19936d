// SPDX-License-Identifier: LGPL-2.1-or-later

// The Mohr-Coulomb yield condition without softening, like 'mohr-coulomb' in
// states that never reach the apex: b = f b_e f^T, eps = ln(b) / 2, and a
// return in Kirchhoff stresses (de Souza Neto, Peric, Owen, section 8.2) to the
// plane
//   f = t_1 - t_3 + (t_1 + t_3) sin(phi) - 2 c cos(phi)
// or to one of the edges beside it; flow with psi in place of phi.
// PROPS: Young's modulus, Poisson's ratio, c, phi and psi in degrees.
// STATEV: b_e - 1 (11, 22, 33, 12, 13, 23), alpha, which grows with
// sqrt(2 / 3) |dev d eps_p|.
#include <greville/materials/umat_arguments.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace
{
  using Vector = std::array<double, 3>;
  using Matrix = std::array<Vector, 3>;

  constexpr int row[] = {0, 1, 2, 0, 0, 1}, column[] = {0, 1, 2, 1, 2, 2};

  Matrix
  from_fortran(const double *A)
  {
    Matrix result;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        result[i][j] = A[i + 3 * j];
    return result;
  }

  Matrix
  multiply(const Matrix &A, const Matrix &B, const bool transposed = false)
  {
    Matrix result{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k)
          result[i][j] += A[i][k] * (transposed ? B[j][k] : B[k][j]);
    return result;
  }

  double
  invert(const Matrix &A, Matrix &inverse)
  {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        inverse[j][i] =
          A[(i + 1) % 3][(j + 1) % 3] * A[(i + 2) % 3][(j + 2) % 3] -
          A[(i + 1) % 3][(j + 2) % 3] * A[(i + 2) % 3][(j + 1) % 3];
    const double det = A[0][0] * inverse[0][0] + A[0][1] * inverse[1][0] +
                       A[0][2] * inverse[2][0];
    for (Vector &entries : inverse)
      for (double &entry : entries)
        entry /= det;
    return det;
  }

  // Return the eigenvalues, with eigenvectors in the columns of V, by Jacobi's
  // method.
  Vector
  eigenvalues(Matrix A, Matrix &V)
  {
    V = {{{{1., 0., 0.}}, {{0., 1., 0.}}, {{0., 0., 1.}}}};
    for (int sweep = 0; sweep < 50; ++sweep)
      for (int p = 0; p < 2; ++p)
        for (int q = p + 1; q < 3; ++q)
          {
            if (std::abs(A[p][q]) <= 1e-40)
              continue;
            const double x = (A[q][q] - A[p][p]) / (2. * A[p][q]);
            const double t =
              (x < 0. ? -1. : 1.) / (std::abs(x) + std::sqrt(x * x + 1.));
            const double c = 1. / std::sqrt(t * t + 1.), s = t * c;
            const auto   turn = [&](double &a, double &b) {
              const double old = a;
              a                = c * old - s * b;
              b                = s * old + c * b;
            };
            for (int k = 0; k < 3; ++k)
              turn(A[k][p], A[k][q]);
            for (int k = 0; k < 3; ++k)
              {
                turn(A[p][k], A[q][k]);
                turn(V[k][p], V[k][q]);
              }
          }
    return {{A[0][0], A[1][1], A[2][2]}};
  }

  // The law K tr(e) 1 + 2 G dev(e) and its inverse.
  struct Elastic
  {
    double K, G;

    Vector
    stress(const Vector &e) const
    {
      const double mean = (K - 2. / 3. * G) * (e[0] + e[1] + e[2]);
      return {
        {mean + 2. * G * e[0], mean + 2. * G * e[1], mean + 2. * G * e[2]}};
    }

    Vector
    strain(const Vector &t) const
    {
      const double mean = (t[0] + t[1] + t[2]) / 3., third = mean / (3. * K);
      return {{third + (t[0] - mean) / (2. * G),
               third + (t[1] - mean) / (2. * G),
               third + (t[2] - mean) / (2. * G)}};
    }
  };

  // Return the normals of planes 1-3, 1-2, 2-3 for the sine of an angle.
  Vector
  normal(const int plane, const double sine)
  {
    Vector n{};
    n[plane == 2 ? 1 : 0] = 1. + sine;
    n[plane == 1 ? 1 : 2] = sine - 1.;
    return n;
  }

  double
  dot(const Vector &a, const Vector &b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  // Return t to plane 1-3 (second < 0), or to its edge with another plane;
  // affine in t.
  Vector
  returned(const Vector  &t,
           const int      second,
           const Elastic &elastic,
           const double   phi,
           const double   psi,
           const double   strength)
  {
    const Vector n1 = normal(0, phi), flow1 = elastic.stress(normal(0, psi));
    const double f1 = dot(n1, t) - strength, a = dot(n1, flow1);
    Vector       result = t;
    if (second < 0)
      for (int i = 0; i < 3; ++i)
        result[i] -= f1 / a * flow1[i];
    else
      {
        const Vector n2    = normal(second, phi),
                     flow2 = elastic.stress(normal(second, psi));
        const double f2 = dot(n2, t) - strength, b = dot(n1, flow2),
                     c = dot(n2, flow1), d = dot(n2, flow2);
        const double det = a * d - b * c;
        for (int i = 0; i < 3; ++i)
          result[i] -=
            ((d * f1 - b * f2) * flow1[i] + (a * f2 - c * f1) * flow2[i]) / det;
      }
    return result;
  }
} // namespace

extern "C" void
umat_(GREVILLE_UMAT_ARGUMENTS)
{
  constexpr double degree = M_PI / 180.;
  const double     E = props[0], nu = props[1];
  const Elastic    elastic{E / (3. * (1. - 2. * nu)), E / (2. * (1. + nu))};
  const double     phi  = std::sin(degree * props[3]),
               psi      = std::sin(degree * props[4]),
               strength = 2. * props[2] * std::cos(degree * props[3]);

  Matrix       inverse, V, b{{{{1., 0., 0.}}, {{0., 1., 0.}}, {{0., 0., 1.}}}};
  const Matrix F1 = from_fortran(dfgrd1);
  invert(from_fortran(dfgrd0), inverse);
  const Matrix f = multiply(F1, inverse);
  const double J = invert(F1, inverse);
  for (int k = 0; k < 6; ++k)
    {
      b[row[k]][column[k]] += statev[k];
      if (k > 2)
        b[column[k]][row[k]] = b[row[k]][column[k]];
    }
  const Vector values = eigenvalues(multiply(multiply(f, b), f, true), V);
  Vector       eps;
  for (int a = 0; a < 3; ++a)
    eps[a] = 0.5 * std::log(values[a]);

  // Sort from the largest to the smallest stress.
  const Vector unsorted = elastic.stress(eps);
  int          order[]  = {0, 1, 2};
  std::sort(order, order + 3, [&](const int a, const int b) {
    return unsorted[a] > unsorted[b];
  });
  Vector trial, strain;
  for (int a = 0; a < 3; ++a)
    {
      trial[a]  = unsorted[order[a]];
      strain[a] = eps[order[a]];
    }
  Vector tau        = trial;
  bool   is_elastic = dot(normal(0, phi), trial) <= strength;
  int    second     = -1;
  if (!is_elastic)
    {
      tau = returned(trial, -1, elastic, phi, psi, strength);
      if (tau[0] < tau[1] || tau[1] < tau[2])
        {
          second =
            (1. - psi) * trial[0] - 2. * trial[1] + (1. + psi) * trial[2] > 0.
              ? 1
              : 2;
          tau = returned(trial, second, elastic, phi, psi, strength);
        }
    }

  // d tau / d eps column by column, because returned() is affine, and the shear
  // moduli (tau_a - tau_b) / (2 tanh(eps_a - eps_b)).
  Matrix D;
  Vector shear;
  for (int a = 0; a < 3; ++a)
    {
      Vector unit{};
      unit[a]           = 1.;
      const Vector sent = elastic.stress(unit);
      const Vector back =
        is_elastic ? sent : returned(sent, second, elastic, phi, psi, 0.);
      for (int i = 0; i < 3; ++i)
        D[i][a] = back[i];
    }
  constexpr int first[] = {0, 0, 1}, other[] = {1, 2, 2};
  for (int m = 0; m < 3; ++m)
    {
      const int    a = first[m], c = other[m];
      const double x = strain[a] - strain[c], gap = trial[a] - trial[c];
      const double ratio =
        gap > 0. ? (tau[a] - tau[c]) / gap : (is_elastic ? 1. : 0.);
      shear[m] = ratio * elastic.G *
                 (std::abs(x) > 1e-4 ? x / std::tanh(x) : 1. + x * x / 3.);
    }

  // Back to x, y, z.
  const int n = *ntens;
  double    diagonal[3][6], mixed[3][6];
  for (int k = 0; k < 6; ++k)
    for (int m = 0; m < 3; ++m)
      {
        const int a = order[first[m]], c = order[other[m]];
        diagonal[m][k] = V[row[k]][order[m]] * V[column[k]][order[m]];
        mixed[m][k] =
          V[row[k]][a] * V[column[k]][c] + V[row[k]][c] * V[column[k]][a];
      }
  for (int i = 0; i < n; ++i)
    {
      stress[i] = 0.;
      for (int a = 0; a < 3; ++a)
        stress[i] += diagonal[a][i] * tau[a] / J;
      for (int j = 0; j < n; ++j)
        {
          double sum = 0.;
          for (int a = 0; a < 3; ++a)
            {
              sum += shear[a] * mixed[a][i] * mixed[a][j];
              for (int c = 0; c < 3; ++c)
                sum += diagonal[a][i] * D[a][c] * diagonal[c][j];
            }
          ddsdde[i + n * j] = sum / J;
        }
    }

  const Vector elastic_strain = elastic.strain(tau);
  Vector       plastic;
  for (int a = 0; a < 3; ++a)
    plastic[a] = is_elastic ? 0. : strain[a] - elastic_strain[a];
  const double volume = (plastic[0] + plastic[1] + plastic[2]) / 3.;
  double       square = 0.;
  for (const double e : plastic)
    square += (e - volume) * (e - volume);
  statev[6] += std::sqrt(2. / 3. * square);
  for (int k = 0; k < 6; ++k)
    {
      statev[k] = 0.;
      for (int a = 0; a < 3; ++a)
        statev[k] += std::expm1(2. * elastic_strain[a]) * diagonal[a][k];
    }
  *sse = 0.5 * dot(tau, elastic_strain) / J;
  *spd += dot(tau, plastic) / J;
}

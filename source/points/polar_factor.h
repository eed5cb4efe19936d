// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include "point_kernels.h"

namespace greville::internal
{
  /// Compute the eigenvalues and eigenvectors (columns of @p V) of symmetric
  /// matrices, one per lane, by Jacobi's method (@ref Golub2013 "Golub and
  /// Van Loan, 2013", section 8.5). The eigenvalues replace the diagonal of
  /// @p A.
  template <int n>
  inline void
  diagonalize(Simd (&A)[n][n], Simd (&V)[n][n])
  {
    // Each sweep squares the errors.
    constexpr int n_sweeps = 6;
    for (int r = 0; r < n; ++r)
      for (int s = 0; s < n; ++s)
        V[r][s] = r == s ? 1. : 0.;
    for (int sweep = 0; sweep < n_sweeps; ++sweep)
      for (int r = 0; r < n; ++r)
        for (int s = r + 1; s < n; ++s)
          {
            const Simd difference = A[s][s] - A[r][r];
            const Simd twice      = 2. * A[r][s];
            const Simd sum =
              abs(difference) + sqrt(difference * difference + twice * twice);
            Simd tangent                    = twice / (sum + 1e-300);
            where(difference < 0., tangent) = -tangent;
            const Simd cosine               = 1. / sqrt(1. + tangent * tangent);
            const Simd sine                 = tangent * cosine;
            const auto rotate               = [&](Simd &x, Simd &y) {
              const Simd old = x;
              x              = cosine * x - sine * y;
              y              = sine * old + cosine * y;
            };
            for (int k = 0; k < n; ++k)
              rotate(A[k][r], A[k][s]);
            for (int k = 0; k < n; ++k)
              rotate(A[r][k], A[s][k]);
            for (int k = 0; k < n; ++k)
              rotate(V[k][r], V[k][s]);
          }
  }



  /// Replace matrices C, one per lane, by the symmetric positive semidefinite
  /// factor H = (C^T C)^(1/2) of their polar decomposition C = Q H.
  template <int n>
  inline void
  replace_by_polar_factor(Simd (&C)[n][n])
  {
    Simd A[n][n], V[n][n];
    Simd largest = 1e-300;
    for (int r = 0; r < n; ++r)
      for (int s = 0; s < n; ++s)
        largest = max(largest, abs(C[r][s]));
    // Scale the matrix, so that squares do not overflow.
    for (int r = 0; r < n; ++r)
      for (int s = 0; s < n; ++s)
        {
          A[r][s] = 0.;
          for (int t = 0; t < n; ++t)
            A[r][s] += C[t][r] / largest * (C[t][s] / largest);
        }
    diagonalize(A, V);
    for (int k = 0; k < n; ++k)
      A[k][k] = largest * sqrt(max(A[k][k], Simd(0.)));
    for (int r = 0; r < n; ++r)
      for (int s = r; s < n; ++s)
        {
          Simd sum = 0.;
          for (int k = 0; k < n; ++k)
            sum += V[r][k] * A[k][k] * V[s][k];
          C[r][s] = C[s][r] = sum;
        }
  }
} // namespace greville::internal

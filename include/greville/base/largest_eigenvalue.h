// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <functional>
#include <vector>

namespace greville
{
  struct LargestEigenvalue
  {
    double value = 0.;
    /// The eigenvector x, with x^T B^-1 x = 1, and b = B^-1 x.
    std::vector<double> x, b;
    /// The number of products with S.
    unsigned int n_products = 0;
    bool         converged  = false;
  };



  /// Collective. A function that computes y = A x for the unknowns of this
  /// process.
  using LinearAction =
    std::function<void(std::vector<double> &y, const std::vector<double> &x)>;

  /**
   * Collective. Return the largest eigenvalue of B S, for two symmetric
   * positive semi-definite matrices: S, and B, which is the inverse of a mass
   * matrix or approximates it. S x = theta B^-1 x is solved by locally optimal
   * conjugate gradients (@ref Knyazev2001 "Knyazev, 2001"): each step minimizes
   * over the span of x, B (S x - theta B^-1 x) and the last direction. A step
   * needs one product with each matrix, nine arrays, and no inverse of B.
   *
   * The result converges from below. Iterations end when each of two
   * consecutive steps has changed it by a relative amount less than @p
   * tolerance. The error may be larger: from an arbitrary start, it is about
   * five times the tolerance.
   *
   * @p start is the first b = B^-1 x, of the unknowns of this process; a
   * LargestEigenvalue::b of a similar problem saves most of the steps. All
   * processes return the same value; zero if B start is zero.
   */
  LargestEigenvalue
  largest_eigenvalue(const LinearAction        &multiply_by_S,
                     const LinearAction        &multiply_by_B,
                     const std::vector<double> &start,
                     const double               tolerance,
                     const unsigned int         max_products,
                     const MPI_Comm             comm);
} // namespace greville

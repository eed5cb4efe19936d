// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_largest_eigenvalue_h
#define greville_base_largest_eigenvalue_h

#include <deal.II/base/mpi.h>

#include <functional>
#include <vector>

namespace greville
{
  /**
   * What largest_eigenvalue() found.
   */
  struct LargestEigenvalue
  {
    double value = 0.;
    /// The eigenvector x, with x^T B^-1 x = 1, and b = B^-1 x.
    std::vector<double> x, b;
    /// Products with S.
    unsigned int n_products = 0;
    bool         converged  = false;
  };



  /**
   * y = A x for the unknowns of this process. Collective.
   */
  using LinearAction =
    std::function<void(std::vector<double> &y, const std::vector<double> &x)>;

  /**
   * Collective. The largest eigenvalue of B S, for two symmetric positive
   * semi-definite matrices: S, and B, which is an inverse of a mass matrix or
   * stands for one. S x = theta B^-1 x is solved by locally optimal conjugate
   * gradients (@ref Knyazev2001 "Knyazev, 2001"): each step takes the best of
   * x, B (S x - theta B^-1 x) and the last direction. That needs one product
   * with each matrix, nine arrays, and no inverse of B.
   *
   * The result comes from below. It is converged when each of two steps in turn
   * has changed it by less than the part @p tolerance, which is no bound of its
   * error: from a start without knowledge of x it is about five times as large.
   *
   * @p start is the first b = B^-1 x, of the unknowns of this process; a
   * LargestEigenvalue::b of a similar problem saves most of the steps. All
   * processes get the same value. Zero if B start is zero.
   */
  LargestEigenvalue
  largest_eigenvalue(const LinearAction        &multiply_by_S,
                     const LinearAction        &multiply_by_B,
                     const std::vector<double> &start,
                     const double               tolerance,
                     const unsigned int         max_products,
                     const MPI_Comm             comm);
} // namespace greville

#endif

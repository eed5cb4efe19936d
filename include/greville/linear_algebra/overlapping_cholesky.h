// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_linear_algebra_overlapping_cholesky_h
#define greville_linear_algebra_overlapping_cholesky_h

#include <deal.II/lac/la_parallel_vector.h>

#include <greville/linear_algebra/incomplete_cholesky.h>
#include <greville/linear_algebra/interleaved_layout.h>

#include <array>
#include <memory>

namespace greville
{
  /**
   * Additive Schwarz with an IncompleteCholesky factorization per process, for
   * a matrix A that is the sum of matrices of all processes, each between the
   * local unknowns of its process.
   *
   * The domain of process s are the unknowns that it owns and some layers of
   * unknowns that A couples with them: a layer has p rows of the lattice for
   * B-splines of order p. With the restriction R_s to this domain and a
   * partition of unity
   * @f$ \sum_s R_s^T W_s R_s = 1 @f$, which falls linearly in the overlap,
   * @f[
   *   B = \sum_s R_s^T W_s^{1/2} (R_s A R_s^T)^{-1} W_s^{1/2} R_s,
   * @f]
   * which is symmetric positive definite (@ref Cai1999 "Cai and Sarkis, 1999",
   * with the square root of the partition of unity on both sides). Each domain
   * is eliminated in lexicographic order. On one process B is
   * IncompleteCholesky.
   *
   * A factorization needs two exchanges with neighbours: the matrix entries of
   * shared rows, and the rows of the overlap. A solve needs two exchanges of
   * vector entries.
   */
  class OverlappingCholesky
  {
  public:
    /**
     * Collective. @p matrix has the entries of this process between the
     * unknowns of @p layout. The owned unknowns have @p positions in a lattice.
     * Apart from few entries, the matrix couples unknowns whose positions
     * differ by at most @p reach; the overlap has @p n_layers of this size.
     * Throws ErrorOnAll if IncompleteCholesky::factorize() throws on any
     * process.
     */
    void
    factorize(const UpperTriangle                            &matrix,
              const std::shared_ptr<const InterleavedLayout> &layout,
              const std::vector<std::array<int, 3>>          &positions,
              const int                                       reach,
              const unsigned int                              n_layers,
              const CholeskyParameters                       &parameters);

    /**
     * Collective. Solve in place for the owned unknowns, @p width columns.
     */
    void
    solve(double *x, const unsigned int width) const;

    /// The same for A / @p unit, for entries of order 1.
    void
    solve(float *x, const unsigned int width, const double unit) const;

  private:
    template <typename Number>
    using Vectors =
      std::array<dealii::LinearAlgebra::distributed::Vector<Number>, 9>;

    /// Solve on the domains, with vectors of them.
    template <typename Number>
    void
    solve(Number            *x,
          const unsigned int width,
          const double       unit,
          Vectors<Number>   &vectors) const;

    void
    factorize_domain(const UpperTriangle                   &matrix,
                     const InterleavedLayout               &layout,
                     const std::vector<std::array<int, 3>> &positions,
                     const int                              reach,
                     const unsigned int                     n_layers,
                     const CholeskyParameters              &parameters);

    /// Set the weights W^{1/2} of the unknowns of the domain.
    void
    find_weights(const std::vector<std::array<int, 3>> &positions,
                 const int                              reach);

    bool                      is_parallel = false;
    unsigned int              n_owned     = 0;
    InterleavedLayout         domain;  // the overlap as ghosts
    std::vector<unsigned int> order;   // local unknown of each row of factors
    std::vector<float>        weights; // by row of factors
    IncompleteCholesky        factors;

    mutable std::vector<float> rows;    // of factors
    mutable Vectors<double>    doubles; // of the domain, by width
    mutable Vectors<float>     floats;
  };
} // namespace greville

#endif

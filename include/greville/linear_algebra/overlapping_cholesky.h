// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/lac/la_parallel_vector.h>

#include <greville/linear_algebra/incomplete_cholesky.h>
#include <greville/linear_algebra/interleaved_layout.h>
#include <greville/linear_algebra/row_variants.h>

#include <algorithm>
#include <array>
#include <memory>

namespace greville
{
  namespace internal
  {
    class OverlappingDomain;
  }

  /**
   * Additive Schwarz with an IncompleteCholesky factorization per process, for
   * a matrix A that is the sum of matrices of all processes, each between the
   * local unknowns of its process.
   *
   * The domain of process s contains the unknowns that it owns and some layers
   * of unknowns that A couples with them. A layer has p rows of the lattice for
   * B-splines of order p. R_s is the restriction to this domain, and
   * @f$ \sum_s R_s^T W_s R_s = 1 @f$ a partition of unity, which falls linearly
   * in the overlap. The preconditioner
   * @f[
   *   B = \sum_s R_s^T W_s^{1/2} (R_s A R_s^T)^{-1} W_s^{1/2} R_s,
   * @f]
   * is symmetric positive definite (@ref Cai1999 "Cai and Sarkis, 1999", with
   * the square root of the partition of unity on both sides). Each domain is
   * eliminated in lexicographic order. On one process, B is an
   * IncompleteCholesky.
   *
   * Components of a field with different matrices have RowVariants. Rows that
   * differ are eliminated last, so that all components share the other columns
   * of the factors. A constrained unknown of a component is divided by its
   * diagonal entry.
   *
   * A factorization needs two exchanges with neighbours for each variant: the
   * matrix entries of shared rows, and the rows of the overlap. A solve needs
   * two exchanges of vector entries.
   */
  class OverlappingCholesky
  {
  public:
    /// Collective. @p matrix has the entries of this process between the
    /// unknowns of @p layout. The owned unknowns have @p positions in a
    /// lattice. Apart from few entries, the matrix couples unknowns whose
    /// positions differ by at most @p reach. The overlap has @p n_layers layers
    /// of this size. Throws ErrorOnAll if IncompleteCholesky::factorize()
    /// throws on any process.
    void
    factorize(const UpperTriangle                   &matrix,
              const InterleavedLayout               &layout,
              const std::vector<std::array<int, 3>> &positions,
              const int                              reach,
              const unsigned int                     n_layers,
              const CholeskyParameters              &parameters,
              const RowVariants                     &variants = RowVariants());

    /// Collective. Solve in place for the owned unknowns and @p width columns,
    /// which are the components of fields one after another.
    void
    solve(double *x, const unsigned int width) const;

    /// Solve in the same way with A / @p unit, for entries of order 1.
    void
    solve(float *x, const unsigned int width, const double unit) const;

  private:
    template <typename Number>
    using Vectors =
      std::array<dealii::LinearAlgebra::distributed::Vector<Number>, 9>;

    /// Solve on the domains, with work @p vectors of the domains.
    template <typename Number>
    void
    solve(Number            *x,
          const unsigned int width,
          const double       unit,
          Vectors<Number>   &vectors) const;

    void
    factorize_domain(internal::OverlappingDomain &rows,
                     const CholeskyParameters    &parameters);

    /// Set the weights W^{1/2} of the unknowns of the domain.
    void
    find_weights(const internal::OverlappingDomain &rows, const int reach);

    /// The last rows of the factors in one variant.
    struct LastRows
    {
      IncompleteCholesky        factors;
      std::vector<unsigned int> fixed;         // numbered among the last rows
      std::vector<float>        inverse_fixed; // unit over the diagonal
    };

    /// Return whether a component has this variant.
    bool
    is_used(const unsigned int variant) const
    {
      return std::find(variant_of_component.begin(),
                       variant_of_component.end(),
                       variant) != variant_of_component.end();
    }

    /// Solve with the factors of the domain in place.
    void
    solve_domain(float *x, const unsigned int width) const;

    bool                      is_parallel = false, has_domain = false;
    unsigned int              n_owned = 0;
    InterleavedLayout         domain;  // the overlap as ghosts
    std::vector<unsigned int> order;   // local unknown of each row of factors
    std::vector<float>        weights; // by row of factors
    IncompleteCholesky        factors;
    std::vector<LastRows>     last_rows; // by variant; empty if there is one
    std::vector<unsigned int> variant_of_component;

    mutable std::vector<float> rows; // of factors
    // Work arrays for the last rows.
    mutable std::vector<float> given, eliminated, solution;
    mutable Vectors<double>    doubles; // of the domain, by width
    mutable Vectors<float>     floats;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/level_operator.h>

#include <functional>
#include <string>

namespace greville
{
  /// An approximate inverse of a sequential matrix, or its transpose, applied
  /// to x in place.
  using LocalSolver = std::function<void(double *x, const bool transpose)>;

  /// Return the upper triangle of a sequential matrix (SeqAIJ).
  UpperTriangle
  upper_triangle(const Mat matrix);



  /**
   * Additive Schwarz with an approximate local solver and one domain per
   * process: its owned unknowns and some layers of overlap in the graph of the
   * matrix. With the prolongation @f$ R_s^T @f$ of domain s, its matrix @f$ A_s
   * = R_s A R_s^T @f$ and partitions of unity @f$ \sum_s R_s^T W_s R_s = 1 @f$:
   * - restricted: @f$ \sum_s R_s^T E_s A_s^{-1} R_s @f$, with @f$ E_s = 1 @f$
   *   for the entries that s owns (@ref Cai1999 "Cai and Sarkis, 1999"). Not
   *   symmetric.
   * - symmetric: @f$ \sum_s R_s^T W_s^{1/2} A_s^{-1} W_s^{1/2} R_s @f$, with
   *   @f$ W_s @f$ one over the number of domains that hold an entry. On several
   *   processes it is scaled so that the largest eigenvalue of its product with
   *   A is at most 1.9. The weights jump at the edge of the overlap, which may
   *   raise the eigenvalue to 8 for extended functions, and two smoothing steps
   *   @f$ 2 B - B A B @f$ are indefinite above 2.
   */
  template <int dim>
  class AdditiveSchwarz : public Preconditioner
  {
  public:
    /// Collective. Set up the method for the matrix() of a level. @p ordering
    /// is "lexicographic" or the name of an ordering of PETSc ("rcm", "amd",
    /// "nd", ...). Throws on all processes if the local solver cannot be made
    /// on one.
    AdditiveSchwarz(const LevelOperator<dim>                    &level,
                    const unsigned int                           overlap,
                    const bool                                   is_symmetric,
                    const std::string                           &ordering,
                    const std::function<LocalSolver(const Mat)> &make);

    void
    vmult(VectorType &dst, const VectorType &src) const override
    {
      apply(dst, src, false);
    }

    void
    Tvmult(VectorType &dst, const VectorType &src) const override
    {
      apply(dst, src, true);
    }

  private:
    void
    apply(VectorType &dst, const VectorType &src, const bool transpose) const;

    /// Collective. Return a lower estimate of the largest eigenvalue of the
    /// product with the matrix of @p level.
    double
    largest_eigenvalue_with(const LevelOperator<dim> &level) const;

    const bool                is_symmetric;
    const unsigned int        n_owned;
    std::vector<unsigned int> order;   // local number in values
    std::vector<double>       weights; // W_s^(1/2)
    LocalSolver               solver;
    double                    scale = 1.; // of the symmetric combination

    mutable VectorType          values; // owned and overlapping entries
    mutable std::vector<double> local;  // in the ordering
  };
} // namespace greville

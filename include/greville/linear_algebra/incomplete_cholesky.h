// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_linear_algebra_incomplete_cholesky_h
#define greville_linear_algebra_incomplete_cholesky_h

#include <greville/linear_algebra/lower_triangle.h>

#include <utility>
#include <vector>

namespace greville
{
  /**
   * Rows that are left out of some of the vectors of a solve. The solve then
   * uses the factors of the other rows; it is the solve with the matrix of the
   * other rows if the omitted rows are the last ones.
   */
  struct ConstrainedRows
  {
    // The rows, ascending, with bits: bit c % n_components leaves the row out
    // of vector c.
    std::vector<std::pair<unsigned int, unsigned char>> rows;
    unsigned int                                        n_components = 1;
  };



  /**
   * The incomplete Cholesky factorization IC(0),
   * @f[ M \approx (1 + L) D (1 + L)^T, @f]
   * where L has entries only where M has (@ref Meijerink1977 "Meijerink and van
   * der Vorst, 1977"). The factorized matrix is scaled to a unit diagonal, to
   * which a shift is added on request. A pivot that is not safely positive is
   * raised to a small number (3e-5), a shift of this row only, which costs
   * fewer iterations than a shift of all rows. If a pivot is far below zero,
   * all rows are shifted, first by 1e-3, then by twice as much until the
   * factorization succeeds (@ref Manteuffel1980 "Manteuffel, 1980"). If the
   * pattern contains the fill, as for a Kronecker product in lexicographic
   * order, the factorization is exact.
   *
   * Positive pivots do not suffice: dropped entries can make the factors nearly
   * singular although M is not, so that a few eigenvalues of the preconditioned
   * matrix are large. If an estimate of the largest eigenvalue exceeds 2, all
   * rows are shifted as well, by 4e-3 at most.
   *
   * Optionally, only the first rows are eliminated, which leaves an incomplete
   * Schur complement of the other rows.
   *
   * Factors and solves use single precision: half the memory traffic, at an
   * error (1e-7) that is negligible in a preconditioner. The matrix is first
   * divided by its largest diagonal entry, so that the unit of mass does not
   * matter.
   *
   * Vectors are interleaved, @p width (1, 2, 4 or 8) of them: entry c of row i
   * is x[i * width + c].
   */
  class IncompleteCholesky
  {
  public:
    /**
     * Factorize the matrix. Throws dealii::ExcMessage if the diagonal is not
     * positive or no shift helps.
     */
    void
    factorize(const LowerTriangle &matrix, const double shift = 0.);

    /**
     * Eliminate the first @p n_eliminated rows. The Schur complement of the
     * other rows, with the pattern of their block of the matrix, is written to
     * @p schur, whose rows are counted from zero. Its diagonal may be zero.
     */
    void
    factorize(const LowerTriangle &matrix,
              const double         shift,
              const unsigned int   n_eliminated,
              LowerTriangle       &schur);

    /// Return the shift that was used.
    double
    shift() const
    {
      return used_shift;
    }

    /// Return the number of pivots that were raised.
    unsigned int
    n_raised() const
    {
      return n_raised_pivots;
    }

    unsigned int
    size() const
    {
      return row_begin.size() - 1;
    }

    /// Return the divisor of the matrix.
    double
    unit() const
    {
      return largest_diagonal;
    }

    /**
     * Solve in place.
     */
    void
    solve(double                *x,
          const unsigned int     width,
          const ConstrainedRows &constrained = ConstrainedRows()) const;

    /**
     * x <- (1 + L)^-1 x. Rows that are not eliminated receive the right-hand
     * side of the Schur complement.
     */
    void
    forward(float                 *x,
            const unsigned int     width,
            const ConstrainedRows &constrained = ConstrainedRows()) const;

    /**
     * x <- (1 + L)^-T (D / unit())^-1 x; rows that are not eliminated contain
     * the solution.
     */
    void
    backward(float                 *x,
             const unsigned int     width,
             const ConstrainedRows &constrained = ConstrainedRows()) const;

  private:
    /**
     * Return an estimate from below of the largest eigenvalue of the
     * preconditioned matrix of the eliminated rows.
     */
    double
    largest_eigenvalue(const LowerTriangle &matrix) const;

    bool
    try_shift(const LowerTriangle       &matrix,
              const std::vector<double> &scaling,
              const double               shift,
              LowerTriangle             &schur);

    template <int width>
    void
    forward_interleaved(float *x, const ConstrainedRows &constrained) const;

    template <int width>
    void
    backward_interleaved(float *x, const ConstrainedRows &constrained) const;

    double                     used_shift       = 0.;
    double                     largest_diagonal = 1.;
    unsigned int               n_raised_pivots  = 0;
    std::vector<std::size_t>   row_begin        = {0};
    std::vector<unsigned int>  columns;
    std::vector<float>         entries;
    std::vector<float>         inverse_pivots; // of eliminated rows
    std::vector<double>        work;
    mutable std::vector<float> single;
  };
} // namespace greville

#endif

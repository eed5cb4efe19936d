// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/upper_triangle.h>

#include <vector>

namespace greville
{
  /// Parameters of an IncompleteCholesky factorization.
  struct CholeskyParameters
  {
    /// Added to the unit diagonal of the scaled matrix.
    double shift = 0.;
    /// Entries of the factor of the scaled matrix below this value are dropped;
    /// 0: IC(0), which keeps the entries that the matrix has.
    double drop_tolerance = 0.;
    /// The largest shift that is tried.
    double largest_shift = 10.;
  };

  /// Return the parameters of ICT for a mass matrix of B-splines of a @p degree
  /// with which a step needs the least time (doc/developer/multigrid.md).
  inline CholeskyParameters
  ict_parameters(const unsigned int degree)
  {
    return degree <= 2   ? CholeskyParameters{0.01, 0.01}
           : degree == 3 ? CholeskyParameters{0.001, 0.001}
           : degree == 4 ? CholeskyParameters{1e-4, 1e-4}
                         : CholeskyParameters{3e-5, 3e-5};
  }



  /**
   * An incomplete Cholesky factorization
   * @f[ M \approx (1 + L) D (1 + L)^T. @f]
   * The factorized matrix is scaled to a unit diagonal, to which a shift can be
   * added. IC(0) keeps entries of L only where M has entries
   * (@ref Meijerink1977 "Meijerink and van der Vorst, 1977"). ICT also keeps
   * fill, but drops entries of @f$ L D^{1/2} @f$ below a tolerance when a
   * column is complete (@ref Saad2003 "Saad, 2003", section 10.4, in its
   * symmetric form).
   *
   * A pivot that is not safely positive is raised to a small number (3e-5).
   * This is a shift of one row, which costs fewer iterations than a shift of
   * all rows. If a pivot is far below zero, all rows are shifted, first by
   * 1e-3, then by twice as much until the factorization succeeds
   * (@ref Manteuffel1980 "Manteuffel, 1980"). If the pattern of IC(0) contains
   * the fill, as for a Kronecker product in lexicographic order, the
   * factorization is exact.
   *
   * Positive pivots do not suffice for IC(0). Dropped entries can make the
   * factors nearly singular although M is not, so that a few eigenvalues of the
   * preconditioned matrix are large. If an estimate of the largest eigenvalue
   * exceeds 2, all rows are also shifted, by 4e-3 at most.
   *
   * Factors and solves use single precision, which halves the memory traffic.
   * The error (1e-7) is negligible in a preconditioner. The matrix is first
   * divided by its largest diagonal entry, so that the unit of mass does not
   * matter.
   *
   * Vectors are interleaved, @p width (1, 2, 4 or 8) of them: entry c of row i
   * is x[i * width + c].
   *
   * The elimination may end before the last rows. Matrices that differ only in
   * these rows share the eliminated columns; each needs a factorization of its
   * complement().
   */
  class IncompleteCholesky
  {
  public:
    /// Factorize the matrix. Throws dealii::ExcMessage if the diagonal is not
    /// positive or no shift helps.
    void
    factorize(const UpperTriangle      &matrix,
              const CholeskyParameters &parameters = CholeskyParameters())
    {
      factorize(matrix, parameters, matrix.size());
    }

    /// Eliminate only the first @p n_columns of the matrix.
    void
    factorize(const UpperTriangle      &matrix,
              const CholeskyParameters &parameters,
              const unsigned int        n_columns);

    /// Return the Schur complement of the last rows, numbered from 0, of a
    /// matrix with the eliminated columns. Its diagonal contains the shift and
    /// is positive. Fixed rows have only a diagonal entry, the unit().
    UpperTriangle
    complement(const UpperTriangle              &last_rows,
               const std::vector<unsigned char> &is_fixed) const;

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

    /// Return the number of columns of L.
    unsigned int
    size() const
    {
      return inverse_pivots.size();
    }

    /// Return the number of entries of L.
    std::size_t
    n_entries() const
    {
      return rows.size();
    }

    /// Solve in place.
    void
    solve(double *x, const unsigned int width) const;

    /// Solve in place in single precision. The entries should be of order 1,
    /// and the solution is multiplied by unit().
    void
    solve(float *x, const unsigned int width) const
    {
      eliminate(x, width);
      substitute(x, width);
    }

    /// The first half of solve(): subtract the eliminated rows from later ones.
    void
    eliminate(float *x, const unsigned int width) const;

    /// The second half of solve(), for a given solution of later rows.
    void
    substitute(float *x, const unsigned int width) const;

    /// Return the number by which the matrix is divided: its largest diagonal
    /// entry.
    double
    unit() const
    {
      return largest_diagonal;
    }

  private:
    /// Return a lower estimate of the largest eigenvalue of the preconditioned
    /// matrix.
    double
    largest_eigenvalue(const UpperTriangle &matrix) const;

    /// Factorize the matrix, scaled by @p scaling from both sides, with
    /// used_shift. Returns false if a pivot is far below zero.
    bool
    factorize_columns(const UpperTriangle       &matrix,
                      const std::vector<double> &scaling,
                      const double               drop_tolerance,
                      const unsigned int         n_columns);

    void
    undo_scaling(const std::vector<double> &scaling);

    double       used_shift       = 0.;
    double       largest_diagonal = 1.;
    unsigned int n_raised_pivots  = 0;

    // L by columns, with ascending rows.
    std::vector<std::size_t>   column_begin = {0};
    std::vector<unsigned int>  rows;
    std::vector<float>         entries;
    std::vector<float>         inverse_pivots;
    mutable std::vector<float> single;
  };
} // namespace greville

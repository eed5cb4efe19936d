#ifndef greville_multigrid_incomplete_cholesky_h
#define greville_multigrid_incomplete_cholesky_h

#include <vector>

namespace greville
{
  /**
   * The lower triangle of a symmetric matrix, by rows: the columns of each row
   * ascend and end with the diagonal.
   */
  struct LowerTriangle
  {
    std::vector<std::size_t>  row_begin = {0};
    std::vector<unsigned int> columns;
    std::vector<double>       values;

    unsigned int
    size() const
    {
      return row_begin.size() - 1;
    }
  };



  /**
   * The incomplete Cholesky factorization IC(0),
   *   M ~ (1 + L) D (1 + L)^T,
   * where L has entries only where M has (J. Meijerink and H. van der Vorst,
   * 1977). It is that of the matrix scaled to a unit diagonal, to which a shift
   * is added where asked for. A pivot that fails, because it is not safely
   * positive, is raised to a small number (3e-5): a shift of this one row only,
   * which costs fewer iterations than one of all rows. Where a pivot is far
   * below zero all rows are shifted, by 1e-3 at first and twice as much as long
   * as it takes (T. Manteuffel, An incomplete factorization technique for
   * positive definite linear systems, 1980). Where the pattern has room for the
   * fill, as for a Kronecker product in lexicographic order, the factorization
   * is exact.
   *
   * The factors are kept, and solves are done, in single precision: half the
   * memory traffic, at an error (1e-7) that a preconditioner does not notice.
   * They are those of the matrix divided by its largest diagonal entry, so that
   * the unit of mass does not matter.
   */
  class IncompleteCholesky
  {
  public:
    /**
     * Throws dealii::ExcMessage where the diagonal is not positive, or no shift
     * helps.
     */
    void
    factorize(const LowerTriangle &matrix, const double shift = 0.);

    /**
     * The shift that was taken.
     */
    double
    shift() const
    {
      return used_shift;
    }

    /**
     * Number of pivots that were raised.
     */
    unsigned int
    n_raised() const
    {
      return n_raised_pivots;
    }

    unsigned int
    size() const
    {
      return inverse_pivots.size();
    }

    /**
     * Solve in place for @p width (1, 2, 4 or 8) interleaved vectors: entry c
     * of unknown i is x[i * width + c].
     */
    void
    solve(double *x, const unsigned int width) const;

    std::size_t
    memory_consumption() const;

  private:
    bool
    try_shift(const LowerTriangle       &matrix,
              const std::vector<double> &scaling,
              const double               shift);

    template <int width>
    void
    solve_interleaved(double *x) const;

    double                     used_shift      = 0.;
    double                     unit            = 1.; // largest diagonal entry
    unsigned int               n_raised_pivots = 0;
    std::vector<std::size_t>   row_begin;
    std::vector<unsigned int>  columns;
    std::vector<float>         entries;
    std::vector<float>         inverse_pivots;
    std::vector<double>        work;
    mutable std::vector<float> single;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_schwarz_h
#define greville_multigrid_schwarz_h

#include <greville/linear_algebra/incomplete_cholesky.h>
#include <greville/linear_algebra/preconditioner.h>
#include <greville/multigrid/level_operator.h>

#include <string>

namespace greville
{
  /**
   * How the corrections of overlapping domains are put together. With the
   * prolongation R_s^T of domain s, its matrix A_s = R_s M R_s^T and the
   * partitions of unity sum_s R_s^T W_s R_s = 1:
   * - restricted: sum_s R_s^T E_s A_s^-1 R_s, with E_s = 1 for the entries that
   *   s owns (X.-C. Cai and M. Sarkis, 1999). Not symmetric.
   * - symmetric: sum_s R_s^T W_s^(1/2) A_s^-1 W_s^(1/2) R_s, with W_s one over
   *   the number of domains that hold an entry.
   */
  enum class SchwarzCombination
  {
    restricted,
    symmetric
  };

  /**
   * The part of a matrix that belongs to this process, with some layers
   * of overlap in the graph of the matrix, and the transport of vectors to it
   * and back. Without other processes it is the matrix itself, not a copy.
   */
  template <int dim>
  class OverlappingDomain
  {
  public:
    /**
     * Collective. For the matrix() of a level. @p ordering is "lexicographic"
     * or the name of an ordering of PETSc ("rcm", "amd", "nd", ...).
     */
    OverlappingDomain(const LevelOperator<dim> &level,
                      const unsigned int        overlap,
                      const SchwarzCombination  combination,
                      const std::string        &ordering);

    /**
     * The local matrix A_s, sequential, in the chosen ordering.
     */
    Mat
    matrix() const
    {
      return local_matrix;
    }

    unsigned int
    size() const
    {
      return order.size();
    }

    MPI_Comm
    communicator() const
    {
      return comm;
    }

    /**
     * Whether this process owns the entry.
     */
    bool
    owns(const unsigned int i) const
    {
      return order[i] < n_owned;
    }

    /**
     * local = R_s src, weighted for the symmetric combination. For the
     * transpose of a restricted combination call with @p transpose.
     */
    void
    restrict_to(std::vector<double> &local,
                const VectorType    &src,
                const bool           transpose) const;

    /**
     * dst = sum_s R_s^T local, weighted or restricted.
     */
    void
    prolongate_from(const std::vector<double> &local,
                    VectorType                &dst,
                    const bool                 transpose) const;

  private:
    SchwarzCombination        combination;
    MPI_Comm                  comm;
    unsigned int              n_owned;
    Mat                       local_matrix = nullptr;
    PetscMatrix               local_copy;
    std::vector<unsigned int> order;   // local number in overlapped
    std::vector<double>       weights; // W_s^(1/2)

    mutable VectorType values; // owned and overlapping entries
  };



  /**
   * A factorization or another approximate inverse of a sequential matrix.
   */
  class LocalSolver
  {
  public:
    virtual ~LocalSolver() = default;

    virtual void
    solve(double *x, const bool transpose) const = 0;
  };

  /**
   * ILUT, see the class of that name.
   */
  std::unique_ptr<LocalSolver>
  make_ilut(const Mat    matrix,
            const double drop_tolerance,
            const double fill_factor);

  /**
   * PETSc's ILU(0) of the matrix scaled to a unit diagonal, with @p shift added
   * to that diagonal.
   */
  std::unique_ptr<LocalSolver>
  make_ilu0(const Mat matrix, const double shift);

  /**
   * IncompleteCholesky with at least this @p shift.
   */
  std::unique_ptr<LocalSolver>
  make_ic0(const Mat matrix, const double shift);

  /**
   * The lower triangle of a sequential matrix (SeqAIJ).
   */
  LowerTriangle
  lower_triangle(const Mat matrix);



  /**
   * Additive Schwarz with one domain per process and an approximate local
   * solver. The constructor is collective; it throws on all processes if the
   * local solver cannot be made on one.
   */
  template <int dim>
  class AdditiveSchwarz : public Preconditioner
  {
  public:
    AdditiveSchwarz(
      std::unique_ptr<const OverlappingDomain<dim>>                 domain,
      const std::function<std::unique_ptr<LocalSolver>(const Mat)> &make);

    void
    vmult(VectorType &dst, const VectorType &src) const override;

    void
    Tvmult(VectorType &dst, const VectorType &src) const override;

  private:
    void
    apply(VectorType &dst, const VectorType &src, const bool transpose) const;

    std::unique_ptr<const OverlappingDomain<dim>> domain;
    std::unique_ptr<LocalSolver>                  solver;
    mutable std::vector<double>                   local;
  };
} // namespace greville

#endif

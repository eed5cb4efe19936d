// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_multigrid_tensor_product_solver_h
#define greville_multigrid_tensor_product_solver_h

#include <greville/linear_algebra/preconditioner.h>
#include <greville/spline/spline_space.h>

namespace greville
{
  /**
   * Moves entries between two distributions of the functions of a space over
   * the processes. Entries are named by their lexicographic positions.
   */
  class Redistribution
  {
  public:
    Redistribution() = default;

    /**
     * Collective. Entry k of the source has the position @p positions[k] and
     * goes to process @p owners[k]; there it takes the place that @p place_of
     * gives for its position.
     */
    Redistribution(
      const std::vector<std::uint64_t>                       &positions,
      const std::vector<unsigned int>                        &owners,
      const std::function<unsigned int(const std::uint64_t)> &place_of,
      const MPI_Comm                                          comm);

    void
    execute(const double *source, double *target) const;

    /**
     * Bytes that this process sends to others in one execute().
     */
    std::size_t
    bytes_sent() const;

  private:
    struct Message
    {
      unsigned int              process;
      std::vector<unsigned int> places;
    };

    MPI_Comm                                 comm = MPI_COMM_NULL;
    std::vector<Message>                     sends, receives;
    std::vector<unsigned int>                own_source, own_target;
    mutable std::vector<std::vector<double>> buffers;
  };



  /**
   * The inverse of M_1 x ... x M_1, the Kronecker product of the mass matrices
   * of the directions (density 1), by banded Cholesky factorizations
   * M_1 = L L^T of these: O(p) operations per coefficient and direction, and no
   * setup worth speaking of. It marks what can be reached at best.
   *
   * On several processes the coefficients move to pencils (complete lines in x,
   * then in y, then in z) and back: dim + 1 redistributions for each solve.
   */
  template <int dim>
  class TensorProductSolver
  {
  public:
    TensorProductSolver() = default;

    /**
     * Collective.
     */
    TensorProductSolver(const SplineSpace<dim> &space);

    /**
     * Overwrite the owned entries of @p x by those of the solution.
     */
    void
    solve(VectorType &x) const;

    unsigned int
    n_unknowns() const
    {
      return space->n_locally_owned_dofs();
    }

    /**
     * The diagonal of M_1 x ... x M_1 at the owned function number @p i.
     */
    double
    diagonal(const unsigned int i) const;

    /**
     * Bytes that this process sends to others in one solve.
     */
    std::size_t
    bytes_sent() const;

  private:
    /**
     * L of one direction: row i has L(i, i - p), ..., L(i, i - 1) and 1/L(i,i).
     */
    struct Factor
    {
      unsigned int        n = 0;
      unsigned int        p = 0;
      std::vector<double> rows;
      std::vector<double> diagonal; // of M_1
    };

    static Factor
    factorize(const KnotVector &knots);

    /**
     * Solve for lines of unknowns: entry i of line l is x[i * stride + l].
     */
    static void
    solve_lines(const Factor      &factor,
                double            *x,
                const std::size_t  stride,
                const unsigned int n_lines);

    void
    solve_on_one_process(double *x) const;

    const SplineSpace<dim>         *space = nullptr;
    std::array<Factor, dim>         factors;
    std::array<Redistribution, dim> to_pencils;
    Redistribution                  to_owners;
    std::array<unsigned int, dim>   n_pencils{};
    mutable std::vector<double>     buffer, other_buffer;
  };



  /**
   * S = D^(1/2) (M_1 x ... x M_1)^-1 D^(1/2) with the diagonal matrix
   * D = diag(M_1 x ... x M_1) / diag(M): exact for constant density, and
   * spectrally close to M^-1 where the density varies slowly from cell to cell
   * (compare L. Gao and V. Calo, Fast isogeometric solvers for explicit
   * dynamics, 2014). Inactive coefficients are divided by their diagonal entry.
   */
  template <int dim>
  class TensorProductPreconditioner : public Preconditioner
  {
  public:
    TensorProductPreconditioner() = default;

    /**
     * The arguments are kept by reference. @p diagonal may have several
     * components, of which the first one counts.
     */
    TensorProductPreconditioner(const TensorProductSolver<dim>  &solver,
                                const VectorType                &diagonal,
                                const std::vector<unsigned int> &inactive);

    void
    vmult(VectorType &dst, const VectorType &src) const override;

  private:
    const TensorProductSolver<dim>  *solver   = nullptr;
    const std::vector<unsigned int> *inactive = nullptr;
    std::vector<double>              diagonal;
    std::vector<double>              scaling; // D^(1/2), 0 where inactive
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi_noncontiguous_partitioner.h>

#include <greville/linear_algebra/preconditioner.h>
#include <greville/spline/spline_space.h>

namespace greville
{
  /**
   * The inverse of @f$ M_1 \otimes \dots \otimes M_1 @f$, the Kronecker product
   * of the mass matrices of the directions (density 1), by banded Cholesky
   * factorizations @f$ M_1 = L L^T @f$: O(p) operations per coefficient and
   * direction, and a negligible set-up. It bounds the speed that other solvers
   * can reach.
   *
   * On several processes the coefficients move to pencils (complete lines in x,
   * then in y, then in z) and back: dim + 1 redistributions for each solve.
   */
  template <int dim>
  class TensorProductSolver
  {
  public:
    /// Collective.
    TensorProductSolver(const SplineSpace<dim> &space);

    /// Overwrite the owned entries of @p x by the solution.
    void
    solve(VectorType &x) const;

    unsigned int
    n_unknowns() const
    {
      return space->n_locally_owned_dofs();
    }

    /// Return the diagonal entry of @f$ M_1 \otimes \dots \otimes M_1 @f$ for
    /// the owned function number @p i.
    double
    diagonal(const unsigned int i) const
    {
      const auto index =
        multi_index<dim>(space->owned_functions()[i], space->n_functions());
      double result = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        result *= factors[d].diagonal[index[d]];
      return result;
    }

    /// Return the bytes that this process sends to others in one solve.
    std::size_t
    bytes_sent() const
    {
      return n_sent * sizeof(double);
    }

  private:
    /// L of one direction: row i has L(i, i - p), ..., L(i, i - 1) and
    /// 1/L(i,i).
    struct Factor
    {
      unsigned int        n = 0;
      unsigned int        p = 0;
      std::vector<double> rows;
      std::vector<double> diagonal; // of M_1
    };

    static Factor
    factorize(const KnotVector &knots);

    /// Solve for lines of unknowns: entry i of line l is x[i * stride + l].
    static void
    solve_lines(const Factor      &factor,
                double            *x,
                const std::size_t  stride,
                const unsigned int n_lines);

    void
    solve_on_one_process(double *x) const;

    const SplineSpace<dim> *space = nullptr;
    std::array<Factor, dim> factors;

    // On several processes: redistributions to the pencils of each direction
    // and back.
    std::vector<dealii::Utilities::MPI::NoncontiguousPartitioner> moves;
    std::size_t                                                   n_sent = 0;
    std::array<unsigned int, dim>                                 n_pencils{};
    mutable std::array<std::vector<double>, dim>                  pencils;
  };



  /**
   * The approximation of @f$ M^{-1} @f$
   * @f[
   *   S = D^{1/2} (M_1 \otimes \dots \otimes M_1)^{-1} D^{1/2}, \qquad
   *   D = \frac{\text{diag}(M_1 \otimes \dots \otimes M_1)}{\text{diag}(M)},
   * @f] which is exact for constant density, and spectrally close to @f$ M^{-1}
   * @f$ if the density varies slowly from cell to cell (compare @ref Gao2014
   * "Gao and Calo, 2014"). Inactive coefficients are divided by their diagonal
   * entry.
   */
  template <int dim>
  class TensorProductPreconditioner : public Preconditioner
  {
  public:
    /// @p inactive is kept by reference. Of several components of @p diagonal,
    /// only the first is used.
    TensorProductPreconditioner(TensorProductSolver<dim>         solver,
                                const VectorType                &diagonal,
                                const std::vector<unsigned int> &inactive);

    void
    vmult(VectorType &dst, const VectorType &src) const override;

  private:
    TensorProductSolver<dim>         solver;
    const std::vector<unsigned int> *inactive;
    std::vector<double>              diagonal;
    std::vector<double>              scaling; // D^(1/2), 0 where inactive
  };
} // namespace greville

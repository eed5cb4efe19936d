// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_linear_algebra_krylov_h
#define greville_linear_algebra_krylov_h

#include <deal.II/lac/solver_control.h>

#include <greville/base/compatibility.h>
#include <greville/linear_algebra/solve_result.h>

#include <functional>

namespace greville
{
  /**
   * Collective. Let @p run(control) run a Krylov method of deal.II for the
   * right-hand side b, until the norm of the residual has fallen to the
   * tolerance times that of b. Where the method does not converge, the result
   * says so; nothing is thrown. Its reduction is what the method itself has
   * computed: the true residual may differ by round-off. For b = 0 nothing
   * runs, so that x has to be zero.
   */
  SolveResult
  run_krylov(const SolverParameters                             &parameters,
             const VectorType                                   &b,
             const std::function<void(dealii::SolverControl &)> &run);

  /// dst = A src, or what a preconditioner makes of src.
  using Product = std::function<void(VectorType &dst, const VectorType &src)>;

  /**
   * Collective. Solve A x = b from x = 0 with a @p preconditioner, as
   * run_krylov() does: by conjugate gradients, or where @p n_basis_vectors is
   * not zero by FGMRES with so many of them between restarts.
   */
  SolveResult
  solve_krylov(const SolverParameters &parameters,
               const Product          &A,
               const Product          &preconditioner,
               VectorType             &x,
               const VectorType       &b,
               const unsigned int      n_basis_vectors = 0);

  /**
   * Why a method that has ended with this reduction has not converged.
   */
  std::string
  reason_of_failure(const unsigned int iterations, const double reduction);
} // namespace greville

#endif

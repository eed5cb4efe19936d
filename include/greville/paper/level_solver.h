// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_paper_level_solver_h
#define greville_paper_level_solver_h

#include <greville/linear_algebra/solve_result.h>
#include <greville/multigrid/level_operator.h>

#include <functional>

namespace greville
{
  /**
   * How to come to the solution of A x = b with a preconditioner B:
   * x += B (b - A x), or a Krylov method, of which flexible_cg and fgmres take
   * a preconditioner that is not linear.
   */
  enum class LevelMethod
  {
    stationary,
    cg,
    flexible_cg,
    fgmres
  };

  /**
   * Collective. Begin with x = 0, let @p run find x and fill in its iterations,
   * and why it failed where it did; then compute the residual. A right-hand
   * side that is not finite is not tried.
   */
  template <int dim>
  SolveResult
  solve_and_check(const LevelOperator<dim>                 &A,
                  VectorType                               &x,
                  const VectorType                         &b,
                  const double                              tolerance,
                  const std::function<void(SolveResult &)> &run);

  /**
   * Collective. Iterate from @p x = 0 until the Euclidean norm of the residual
   * has fallen by the tolerance: what solve_and_check() takes. Without a
   * preconditioner (null) it is the unit matrix.
   */
  template <int dim>
  void
  iterate(const LevelMethod         method,
          const LevelOperator<dim> &A,
          const Preconditioner     *preconditioner,
          const SolverParameters   &parameters,
          VectorType               &x,
          const VectorType         &b,
          SolveResult              &result);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/krylov.h>
#include <greville/multigrid/level_operator.h>

#include <functional>
#include <string>

namespace greville
{
  /// The iteration for A x = b with a preconditioner B: x += B (b - A x), or a
  /// Krylov method. flexible_cg and fgmres support a nonlinear preconditioner.
  enum class LevelMethod
  {
    stationary,
    cg,
    flexible_cg,
    fgmres
  };

  /// Collective. Begin with x = 0, call @p run, which finds x and returns the
  /// iterations and the reason of a failure, and compute the residual. Fails
  /// without a call if the right-hand side is not finite.
  SolveResult
  solve_and_check(const Product                      &A,
                  VectorType                         &x,
                  const VectorType                   &b,
                  const double                        tolerance,
                  const std::function<SolveResult()> &run);

  template <int dim>
  SolveResult
  solve_and_check(const LevelOperator<dim>           &A,
                  VectorType                         &x,
                  const VectorType                   &b,
                  const double                        tolerance,
                  const std::function<SolveResult()> &run)
  {
    return solve_and_check([&](VectorType       &dst,
                               const VectorType &src) { A.vmult(dst, src); },
                           x,
                           b,
                           tolerance,
                           run);
  }

  /// Collective. Iterate from @p x = 0 until the Euclidean norm of the residual
  /// has fallen by the tolerance; for solve_and_check(). A null preconditioner
  /// is the unit matrix.
  template <int dim>
  SolveResult
  iterate(const LevelMethod         method,
          const LevelOperator<dim> &A,
          const Preconditioner     *preconditioner,
          const SolverParameters   &parameters,
          VectorType               &x,
          const VectorType         &b);

  /// Return whether a solver takes the parameters of p-multigrid.
  inline bool
  takes_cycle(const std::string &solver)
  {
    return solver.find("p-multigrid") != std::string::npos;
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>

#include <greville/base/errors.h>
#include <greville/linear_algebra/krylov.h>
#include <greville/paper/level_solver.h>



namespace greville
{
  using namespace dealii;

  SolveResult
  solve_and_check(const Product                      &A,
                  VectorType                         &x,
                  const VectorType                   &b,
                  const double                        tolerance,
                  const std::function<SolveResult()> &run)
  {
    SolveResult result;
    x                 = 0.;
    const double norm = b.l2_norm();
    if (!std::isfinite(norm))
      {
        result.iterations = 0;
        result.reduction  = 1.;
        result.converged  = false;
        result.reason     = "has a right-hand side that is infinite or NaN";
        return result;
      }
    result = run();

    VectorType residual(b);
    A(residual, x);
    residual.sadd(-1., 1., b);
    result.reduction = norm > 0. ? residual.l2_norm() / norm : 0.;

    // Recursive and true residual may differ by round-off.
    result.converged = result.reduction <= 1.01 * tolerance;
    if (!result.converged && result.reason.empty())
      result.reason =
        (result.iterations ? "did not reach the tolerance: round-off keeps the "
                             "true residual at "
                           : "is a direct approximation; the residual is ") +
        text_of(result.reduction) + " times the right-hand side";
    return result;
  }



  namespace
  {
    template <int dim>
    SolveResult
    improve(const LevelOperator<dim> &A,
            const Preconditioner     &preconditioner,
            const SolverParameters   &parameters,
            VectorType               &x,
            const VectorType         &b)
    {
      SolveResult  result;
      VectorType   residual(b), correction(b);
      const double start     = b.l2_norm();
      double       reduction = start > 0. ? 1. : 0.;
      unsigned int k         = 0;
      while (reduction > parameters.tolerance && reduction < 1e6 &&
             k < parameters.max_iterations)
        {
          preconditioner.vmult(correction, residual);
          x += correction;
          A.vmult(residual, x);
          residual.sadd(-1., 1., b);
          reduction = residual.l2_norm() / start;
          ++k;
        }
      result.iterations = k;
      if (!(reduction <= parameters.tolerance))
        result.reason = reason_of_failure(k, reduction);
      return result;
    }
  } // namespace



  template <int dim>
  SolveResult
  iterate(const LevelMethod         method,
          const LevelOperator<dim> &A,
          const Preconditioner     *preconditioner,
          const SolverParameters   &parameters,
          VectorType               &x,
          const VectorType         &b)
  {
    if (method == LevelMethod::stationary)
      {
        AssertThrow(preconditioner, ExcNotInitialized());
        return improve<dim>(A, *preconditioner, parameters, x, b);
      }
    return run_krylov(parameters, b, [&](SolverControl &control) {
      GrowingVectorMemory<VectorType> memory;
      if (!preconditioner)
        SolverCG<VectorType>(control, memory)
          .solve(A, x, b, PreconditionIdentity());
      else if (method == LevelMethod::fgmres)
        SolverFGMRES<VectorType>(control,
                                 memory,
                                 fgmres_data<SolverFGMRES<VectorType>>(30))
          .solve(A, x, b, *preconditioner);
      else if (method == LevelMethod::flexible_cg)
        SolverFlexibleCG<VectorType>(control, memory)
          .solve(A, x, b, *preconditioner);
      else
        SolverCG<VectorType>(control, memory).solve(A, x, b, *preconditioner);
    });
  }



  GREVILLE_INSTANTIATE(iterate);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>

#include <greville/linear_algebra/krylov.h>

#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  SolveResult
  run_krylov(const SolverParameters                     &parameters,
             const VectorType                           &b,
             const std::function<void(SolverControl &)> &run)
  {
    SolveResult  result;
    const double start = b.l2_norm();
    result.iterations  = 0;
    result.converged   = start == 0.;
    if (start == 0.)
      return result;
    // deal.II's methods throw an exception if they do not converge.
    SolverControl control(parameters.max_iterations,
                          parameters.tolerance * start,
                          false,
                          false);
    try
      {
        run(control);
        result.converged = true;
      }
    catch (const SolverControl::NoConvergence &)
      {}
    result.iterations = control.last_step();
    result.reduction  = control.last_value() / start;
    if (!result.converged)
      result.reason = reason_of_failure(*result.iterations, result.reduction);
    return result;
  }



  SolveResult
  solve_krylov(const SolverParameters &parameters,
               const Product          &A,
               const Product          &preconditioner,
               VectorType             &x,
               const VectorType       &b,
               const unsigned int      n_basis_vectors)
  {
    struct Operator
    {
      void
      vmult(VectorType &dst, const VectorType &src) const
      {
        product(dst, src);
      }

      const Product &product;
    };
    x = 0.;
    return run_krylov(parameters, b, [&](SolverControl &control) {
      using Fgmres = SolverFGMRES<VectorType>;
      const Operator matrix{A}, inverse{preconditioner};
      if (n_basis_vectors == 0)
        SolverCG<VectorType>(control).solve(matrix, x, b, inverse);
      else
        Fgmres(control, fgmres_data<Fgmres>(n_basis_vectors))
          .solve(matrix, x, b, inverse);
    });
  }



  std::string
  reason_of_failure(const unsigned int iterations, const double reduction)
  {
    std::ostringstream reason;
    if (!std::isfinite(reduction) || reduction > 1e3)
      reason << "diverged: the residual is " << reduction
             << " times the right-hand side after " << iterations
             << " iterations";
    else
      reason << "did not converge in " << iterations
             << " iterations; the residual is " << reduction
             << " times the right-hand side";
    return reason.str();
  }
} // namespace greville

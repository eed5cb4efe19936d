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
    struct NotPositive
    {};
    struct Operator
    {
      void
      vmult(VectorType &dst, const VectorType &src) const
      {
        product(dst, src);
        // Directions and residuals of conjugate gradients are not zero.
        if (must_be_positive && dst * src <= 0.)
          throw NotPositive();
      }

      const Product &product;
      const bool     must_be_positive;
    };
    x                     = 0.;
    bool         takes_cg = n_basis_vectors == 0;
    unsigned int n_of_cg  = 0;
    const auto   run      = [&](SolverControl &control) {
      using Fgmres = SolverFGMRES<VectorType>;
      const Operator matrix{A, takes_cg}, inverse{preconditioner, takes_cg};
      if (takes_cg)
        try
          {
            SolverCG<VectorType>(control).solve(matrix, x, b, inverse);
            return;
          }
        catch (const NotPositive &)
          {
            n_of_cg = control.last_step();
          }
      constexpr unsigned int n_after_cg = 50;
      Fgmres(control,
             fgmres_data<Fgmres>(takes_cg ? n_after_cg : n_basis_vectors))
        .solve(Operator{A, false}, x, b, Operator{preconditioner, false});
    };
    SolveResult result = run_krylov(parameters, b, run);
    *result.iterations += n_of_cg;
    return result;
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

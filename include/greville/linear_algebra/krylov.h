// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/lac/solver_control.h>

#include <greville/base/compatibility.h>
#include <greville/linear_algebra/solve_result.h>

#include <functional>

namespace greville
{
  /// Collective. Call @p run(control), which runs a Krylov method of deal.II
  /// for the right-hand side b until the norm of the residual is below the
  /// tolerance times the norm of b. If the method does not converge, the result
  /// says so; nothing is thrown. The method computes the reduction in the
  /// result; the true residual may differ by round-off. If b = 0, nothing runs,
  /// so x must be zero.
  SolveResult
  run_krylov(const SolverParameters                             &parameters,
             const VectorType                                   &b,
             const std::function<void(dealii::SolverControl &)> &run);

  /// A function dst = A src, or the application of a preconditioner to src.
  using Product = std::function<void(VectorType &dst, const VectorType &src)>;

  /// Collective. Solve A x = b from x = 0 with a @p preconditioner B, like
  /// run_krylov(): by conjugate gradients, or, if @p n_basis_vectors is not
  /// zero, by FGMRES with this number of basis vectors between restarts. If
  /// conjugate gradients find d^T A d <= 0 or r^T B r <= 0, FGMRES continues.
  SolveResult
  solve_krylov(const SolverParameters &parameters,
               const Product          &A,
               const Product          &preconditioner,
               VectorType             &x,
               const VectorType       &b,
               const unsigned int      n_basis_vectors = 0);

  /// Return why a method that has ended with this reduction did not converge.
  std::string
  reason_of_failure(const unsigned int iterations, const double reduction);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/linear_algebra/solve_result.h>

namespace greville
{
  using namespace dealii;

  void
  SolverParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Tolerance",
      tolerance,
      "Iterations end when the Euclidean norm of the residual has fallen to "
      "this part of that of the right-hand side. Unit: none.",
      Patterns::Double(1e-15, 1.));
    prm.add_parameter(
      "Maximum iterations",
      max_iterations,
      "A solver that needs more has not converged. Unit: iterations.",
      Patterns::Integer(1));
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_acceptor.h>

#include <optional>
#include <string>

namespace greville
{
  /// The stopping criteria of an iterative solver.
  struct SolverParameters
  {
    void
    declare(dealii::ParameterHandler &prm)
    {
      prm.add_parameter(
        "Tolerance",
        tolerance,
        "Largest Euclidean norm of the residual over the norm of the "
        "right-hand side at which iterations end. Unit: none.",
        dealii::Patterns::Double(1e-15, 1.));
      prm.add_parameter("Maximum iterations",
                        max_iterations,
                        "Largest number of iterations; a solver that needs "
                        "more has not converged. Unit: iterations.",
                        dealii::Patterns::Integer(1));
    }

    double       tolerance      = 1e-8;
    unsigned int max_iterations = 1000;
  };



  /// The outcome of a solve.
  struct SolveResult
  {
    /// The number of iterations; empty for solvers that do not iterate to a
    /// tolerance.
    std::optional<unsigned int> iterations;
    bool                        converged = false;
    /// The Euclidean norm of b - M x relative to the norm of b, computed at the
    /// end.
    double reduction = 0.;
    /// The reason why the solver did not converge; empty if it did.
    std::string reason;
  };
} // namespace greville

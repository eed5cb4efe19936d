#include <greville/linear_algebra/solve_result.h>

namespace greville
{
  using namespace dealii;

  SolverParameters::SolverParameters(const std::string &section)
    : ParameterAcceptor(section)
  {
    add_parameter("Tolerance",
                  tolerance,
                  "Iterations end when the Euclidean norm of the residual has "
                  "fallen to this part of that of the right-hand side. Unit: "
                  "none.",
                  prm,
                  Patterns::Double(1e-15, 1.));
    add_parameter("Maximum iterations",
                  max_iterations,
                  "A solver that needs more has not converged. Unit: "
                  "iterations.",
                  prm,
                  Patterns::Integer(1));
  }
} // namespace greville

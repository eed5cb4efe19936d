// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/newton.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  void
  NewtonParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Tolerance",
      tolerance,
      "Newton's method ends where the residual is this fraction of the largest "
      "of the forces that it is the sum of: those of stresses, loads and "
      "inertia. Unit: none.",
      Patterns::Double(0., 1.));
    prm.add_parameter("Absolute tolerance",
                      absolute_tolerance,
                      "It ends, too, where the residual is smaller than this. "
                      "Unit: N (2D: N / m).",
                      Patterns::Double(0.));
    prm.add_parameter("Maximum iterations",
                      max_iterations,
                      "A step that needs more is cut in halves. Unit: "
                      "iterations.",
                      Patterns::Integer(1));
    prm.add_parameter("Maximum line search steps",
                      max_cuts,
                      "How often an iteration may halve its step where the "
                      "residual grows. Unit: none.",
                      Patterns::Integer(0, 50));
    prm.add_parameter("Largest linear tolerance",
                      largest_forcing,
                      "Linear systems are solved to this relative residual at "
                      "least, and the more exactly the faster Newton's method "
                      "converges. Unit: none.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Smallest linear tolerance",
                      smallest_forcing,
                      "And never more exactly than this. Unit: none.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Print iterations",
                      log,
                      "Whether a line is printed for each iteration.",
                      Patterns::Bool());
  }



  namespace
  {
    // Iterations without a line search that may pass until the residual becomes
    // smaller than it was before.
    constexpr unsigned int watch = 4;



    /**
     * Newton's method from the guess @p x.
     */
    NewtonResult
    solve_from(VectorType             &x,
               const NewtonProblem    &problem,
               const NewtonParameters &parameters)
    {
      NewtonResult result;
      VectorType   r, dx, trial, trial_r;
      for (VectorType *vector : {&r, &dx, &trial, &trial_r})
        vector->reinit(x);

      std::string wrong = problem.residual(r, x);
      double      norm  = r.l2_norm();
      if (!wrong.empty() || !std::isfinite(norm))
        {
          result.reason =
            wrong.empty() ? "the initial residual is infinite or NaN" : wrong;
          return result;
        }
      // That of the forces at x. At a trial far away it may be any number.
      double          scale = problem.scale();
      NewtonIteration row;
      const auto      add_row = [&]() {
        const double largest = std::max(scale, norm);
        row.residual         = norm;
        row.relative         = largest > 0. ? norm / largest : 0.;
        result.iterations.push_back(row);
      };
      add_row();
      double forcing = parameters.largest_forcing;

      // Where the residual was smallest, and the steps without a line search
      // since.
      VectorType   best = x, best_r = r;
      double       best_norm = norm, best_scale = scale;
      unsigned int n_free  = 0;
      bool         is_free = true;
      const auto   go_back = [&]() {
        x        = best;
        r        = best_r;
        norm     = best_norm;
        scale    = best_scale;
        is_free  = false;
        n_free   = 0;
        forcing  = parameters.largest_forcing;
        row.step = 0.;
        add_row();
      };
      for (unsigned int k = 0;; ++k)
        {
          if (result.iterations.back().relative <= parameters.tolerance ||
              norm <= parameters.absolute_tolerance)
            {
              result.converged = true;
              return result;
            }
          if (k == parameters.max_iterations)
            {
              std::ostringstream text;
              text << "Newton's method did not converge in " << k
                   << " iterations: the residual is "
                   << result.iterations.back().relative
                   << " of the forces, and 'Newton/Tolerance' is "
                   << parameters.tolerance;
              result.reason = text.str();
              return result;
            }
          wrong = problem.linearize(x);
          SolveResult solve;
          if (wrong.empty())
            {
              solve                 = problem.solve(dx, r, forcing);
              row.linear_iterations = *solve.iterations;
              if (!solve.converged && !(solve.reduction < 0.5))
                wrong = "the linear solver " + solve.reason;
            }
          if (!wrong.empty())
            {
              if (n_free > 0)
                {
                  go_back();
                  continue;
                }
              result.reason = wrong;
              return result;
            }

          const double     old_norm = norm;
          constexpr double decrease = 1e-4;
          row.step                  = 1.;
          for (unsigned int cut = 0;; ++cut, row.step *= 0.5)
            {
              trial = x;
              trial.add(row.step, dx);
              wrong = problem.residual(trial_r, trial);
              norm  = trial_r.l2_norm();
              if (wrong.empty() &&
                  norm <= (1. - decrease * row.step) * best_norm)
                break;
              // Round-off: it does not get better.
              if (wrong.empty() && std::isfinite(norm) &&
                  norm <= 10. * parameters.tolerance * scale)
                break;
              if (is_free)
                break;
              if (cut == parameters.max_cuts)
                {
                  if (wrong.empty() && norm < 2. * old_norm)
                    break;
                  result.reason = wrong.empty()
                                    ? "Newton's method found no step that "
                                      "reduces the residual"
                                    : wrong;
                  return result;
                }
            }
          const bool is_good = wrong.empty() && std::isfinite(norm);
          if (is_free && (!is_good || (norm > best_norm && ++n_free > watch)))
            {
              go_back();
              continue;
            }
          x.swap(trial);
          r.swap(trial_r);
          scale = problem.scale();
          add_row();
          if (norm < best_norm || !is_free)
            {
              best       = x;
              best_r     = r;
              best_norm  = norm;
              best_scale = scale;
              n_free     = 0;
            }
          const double ratio = norm / old_norm;
          forcing =
            std::min(std::max({0.9 * ratio * ratio,
                               parameters.smallest_forcing,
                               0.5 * parameters.tolerance /
                                 std::max(result.iterations.back().relative,
                                          parameters.tolerance)}),
                     parameters.largest_forcing);
        }
    }



    /**
     * Whether a guess that Newton's method could not use is worse than zero:
     * the residual is infinite or NaN there, or much larger.
     */
    bool
    zero_is_better(const NewtonResult  &failed,
                   const NewtonProblem &problem,
                   const VectorType    &layout)
    {
      constexpr double much = 10.;
      if (failed.iterations.empty())
        return true;
      VectorType zero, r;
      zero.reinit(layout);
      r.reinit(layout);
      return problem.residual(r, zero).empty() &&
             much * r.l2_norm() < failed.iterations[0].residual;
    }
  } // namespace



  NewtonResult
  solve_newton(VectorType             &x,
               const NewtonProblem    &problem,
               const NewtonParameters &parameters)
  {
    NewtonResult result = solve_from(x, problem, parameters);
    if (!result.converged && zero_is_better(result, problem, x))
      {
        x           = 0.;
        auto before = std::move(result.iterations);
        result      = solve_from(x, problem, parameters);
        before.insert(before.end(),
                      result.iterations.begin(),
                      result.iterations.end());
        result.iterations = std::move(before);
      }
    return result;
  }
} // namespace greville

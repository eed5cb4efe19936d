// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/newton.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;



  namespace
  {
    // Iterations without a line search that may pass until the residual becomes
    // smaller than it was before.
    constexpr unsigned int watch = 4;

    // Linear systems are solved no more exactly than to this relative residual.
    constexpr double smallest_forcing = 1e-8;



    /**
     * Where Newton's method is, and what it knows of that place. At a trial far
     * away the forces may have any size.
     */
    struct Iterate
    {
      VectorType x, r;
      double     norm = 0., scale = 0.;

      double
      relative() const
      {
        const double largest = std::max(scale, norm);
        return largest > 0. ? norm / largest : 0.;
      }
    };



    /**
     * Newton's method from the guess @p x.
     */
    NewtonResult
    solve_from(VectorType             &x,
               NewtonProblem          &problem,
               const NewtonParameters &parameters)
    {
      NewtonResult result;
      Iterate      now, best;
      VectorType   dx, trial, trial_r;
      now.x = x;
      for (VectorType *vector : {&now.r, &dx, &trial, &trial_r})
        vector->reinit(x);

      // What counts as zero there.
      const auto limit = [&](const Iterate &at) {
        return std::max(parameters.tolerance * std::max(at.scale, at.norm),
                        parameters.absolute_tolerance);
      };
      const auto measure = [&](Iterate &at) {
        at.norm  = at.r.l2_norm();
        at.scale = problem.scale();
      };
      const auto end_with = [&](const std::string &reason) {
        result.converged = reason.empty();
        result.reason    = reason;
        x.swap(now.x);
        return result;
      };

      std::string wrong = problem.residual(now.r, now.x);
      if (wrong.empty() && !std::isfinite(now.r.l2_norm()))
        wrong = "the initial residual is infinite or NaN";
      if (!wrong.empty())
        return end_with(wrong);
      measure(now);
      NewtonIteration row;
      const auto      add_row = [&]() {
        row.residual = now.norm;
        row.relative = now.relative();
        result.iterations.push_back(row);
      };
      add_row();
      double forcing = parameters.largest_forcing;

      // Where the residual was smallest, and the steps without a line search
      // since.
      best                 = now;
      unsigned int n_free  = 0;
      bool         is_free = true;
      const auto   go_back = [&]() {
        now      = best;
        is_free  = false;
        n_free   = 0;
        forcing  = parameters.largest_forcing;
        row.step = 0.;
        add_row();
      };
      for (unsigned int k = 0;; ++k)
        {
          if (now.norm <= limit(now))
            return end_with("");
          if (k == parameters.max_iterations)
            {
              std::ostringstream text;
              text << "Newton's method did not converge in " << k
                   << " iterations: the residual is " << now.relative()
                   << " of the forces, and 'Newton/Tolerance' is "
                   << parameters.tolerance;
              return end_with(text.str());
            }
          wrong = problem.linearize(now.x);
          SolveResult solve;
          if (wrong.empty())
            {
              solve                 = problem.solve(dx, now.r, forcing);
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
              return end_with(wrong);
            }

          constexpr double       decrease = 1e-4;
          constexpr unsigned int max_cuts = 6;
          double                 norm     = 0.;
          row.step                        = 1.;
          for (unsigned int cut = 0;; ++cut, row.step *= 0.5)
            {
              trial = now.x;
              trial.add(row.step, dx);
              wrong = problem.residual(trial_r, trial);
              norm  = trial_r.l2_norm();
              if (wrong.empty() && !std::isfinite(norm))
                wrong = "the residual is infinite or NaN";
              if (is_free || (wrong.empty() &&
                              norm <= (1. - decrease * row.step) * best.norm))
                break;
              // Round-off: it does not get better.
              if (wrong.empty() && norm <= 10. * limit(now))
                break;
              if (cut == max_cuts)
                return end_with(
                  wrong.empty() ? "Newton's method found no step that reduces "
                                  "the residual"
                                : wrong);
            }
          if (is_free &&
              (!wrong.empty() || (norm > best.norm && ++n_free > watch)))
            {
              go_back();
              continue;
            }
          const double ratio = norm / now.norm;
          now.x.swap(trial);
          now.r.swap(trial_r);
          measure(now);
          add_row();
          if (norm < best.norm || !is_free)
            {
              best   = now;
              n_free = 0;
            }
          forcing =
            std::min(std::max({0.9 * ratio * ratio,
                               smallest_forcing,
                               0.5 * limit(now) / std::max(norm, limit(now))}),
                     parameters.largest_forcing);
        }
    }



    /**
     * Whether a guess that Newton's method could not use is worse than zero:
     * the residual is infinite or NaN there, or much larger.
     */
    bool
    zero_is_better(const NewtonResult &failed,
                   NewtonProblem      &problem,
                   const VectorType   &layout)
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
               NewtonProblem          &problem,
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

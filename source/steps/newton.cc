// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/newton.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;



  namespace
  {
    // Iterations without a line search in which the residual must fall below
    // its smallest value.
    constexpr unsigned int watch = 4;

    // The smallest relative residual to which linear systems are solved.
    constexpr double smallest_forcing = 1e-8;



    /// An iterate with its residual and the scale of its forces. A distant
    /// trial may have forces of any size.
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



    class NewtonIterations
    {
    public:
      NewtonIterations(const VectorType       &guess,
                       NewtonProblem          &problem,
                       const NewtonParameters &parameters)
        : problem(problem)
        , parameters(parameters)
        , forcing(parameters.largest_forcing)
      {
        now.x = guess;
        for (VectorType *vector : {&now.r, &dx, &trial, &trial_r})
          vector->reinit(guess);
      }

      NewtonResult
      run(VectorType &x)
      {
        result.reason    = iterate();
        result.converged = result.reason.empty();
        x.swap(now.x);
        return result;
      }

    private:
      /// Return an empty text, or the reason for a failure.
      std::string
      iterate()
      {
        std::string wrong = problem.residual(now.r, now.x);
        if (wrong.empty() && !std::isfinite(now.r.l2_norm()))
          wrong = "the initial residual is infinite or NaN";
        if (!wrong.empty())
          return wrong;
        measure(now);
        add_row();
        best = now;
        for (unsigned int k = 0; now.norm > limit(now); ++k)
          {
            if (k == parameters.max_iterations)
              return describe_slowness();
            wrong = solve_linear_system();
            if (!wrong.empty())
              {
                if (n_free == 0)
                  return wrong;
                go_back();
                continue;
              }
            if (!find_trial(wrong))
              return wrong;
            if (is_free &&
                (!wrong.empty() || (norm > best.norm && ++n_free > watch)))
              go_back();
            else
              accept_trial();
          }
        if (result.iterations.size() > 1)
          reduce_round_off();
        return "";
      }

      /// Take one more step if the residual is below the limit only because of
      /// an upper bound of round-off. The rest would do work in each step of a
      /// run.
      void
      reduce_round_off()
      {
        const double likely_limit =
          std::max(parameters.tolerance *
                     std::max(problem.likely_scale(), now.norm),
                   parameters.absolute_tolerance);
        if (now.norm <= likely_limit)
          return;
        forcing = 0.5 * likely_limit / now.norm;
        if (!solve_linear_system().empty())
          return;
        trial = now.x;
        trial.add(1., dx);
        const std::string wrong = problem.residual(trial_r, trial);
        norm                    = trial_r.l2_norm();
        row.step                = 1.;
        if (wrong.empty() && norm < now.norm)
          accept_trial();
        else
          problem.residual(now.r, now.x);
      }

      /// Return the norm below which the residual at an iterate counts as zero.
      double
      limit(const Iterate &at) const
      {
        return std::max(parameters.tolerance * std::max(at.scale, at.norm),
                        parameters.absolute_tolerance);
      }

      void
      measure(Iterate &at)
      {
        at.norm  = at.r.l2_norm();
        at.scale = problem.scale();
      }

      void
      add_row()
      {
        row.residual = now.norm;
        row.relative = now.relative();
        result.iterations.push_back(row);
      }

      std::string
      describe_slowness() const
      {
        return "Newton's method did not converge in " +
               std::to_string(parameters.max_iterations) +
               " iterations: the residual is " + text_of(now.relative()) +
               " of the forces, and 'Newton/Tolerance' is " +
               text_of(parameters.tolerance);
      }

      /// Return an empty text, or the reason why no direction was found.
      std::string
      solve_linear_system()
      {
        const std::string wrong = problem.linearize(now.x);
        if (!wrong.empty())
          return wrong;
        const SolveResult solve = problem.solve(dx, now.r, forcing);
        row.linear_iterations   = *solve.iterations;
        return solve.converged || solve.reduction < 0.5
                 ? ""
                 : "the linear solver " + solve.reason;
      }

      /// Set the trial to a full step or, with a line search, to a step that
      /// reduces the residual, and @p wrong to the error there, if any. Return
      /// whether there is such a step; if not, @p wrong says why.
      bool
      find_trial(std::string &wrong)
      {
        constexpr double       decrease = 1e-4;
        constexpr unsigned int max_cuts = 6;
        row.step                        = 1.;
        for (unsigned int cut = 0;; ++cut, row.step *= 0.5)
          {
            trial = now.x;
            trial.add(row.step, dx);
            wrong = problem.residual(trial_r, trial);
            norm  = trial_r.l2_norm();
            if (wrong.empty() && !std::isfinite(norm))
              wrong = "the residual is infinite or NaN";
            // Round-off may keep the residual within 10 times the limit.
            if (is_free || (wrong.empty() &&
                            (norm <= (1. - decrease * row.step) * best.norm ||
                             norm <= 10. * limit(now))))
              return true;
            if (cut < max_cuts)
              continue;
            if (wrong.empty())
              wrong = "Newton's method found no step that reduces the residual";
            return false;
          }
      }

      /// Return to the iterate with the smallest residual, and use line
      /// searches.
      void
      go_back()
      {
        now      = best;
        is_free  = false;
        n_free   = 0;
        forcing  = parameters.largest_forcing;
        row.step = 0.;
        add_row();
      }

      void
      accept_trial()
      {
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

      NewtonProblem          &problem;
      const NewtonParameters &parameters;
      NewtonResult            result;
      NewtonIteration         row;
      Iterate                 now, best; // best: the smallest residual
      VectorType              dx, trial, trial_r;
      double                  norm = 0.; // of trial_r
      double                  forcing;
      bool                    is_free = true; // without a line search
      unsigned int            n_free  = 0;    // such steps since best
    };



    /// Return whether zero is a better guess: at the guess that failed, the
    /// residual is infinite, NaN, or much larger.
    bool
    zero_is_better(const NewtonResult &failed,
                   NewtonProblem      &problem,
                   const VectorType   &layout)
    {
      constexpr double allowed_growth = 10.;
      if (failed.iterations.empty())
        return true;
      VectorType zero, r;
      zero.reinit(layout);
      r.reinit(layout);
      return problem.residual(r, zero).empty() &&
             allowed_growth * r.l2_norm() < failed.iterations[0].residual;
    }
  } // namespace



  NewtonResult
  solve_newton(VectorType             &x,
               NewtonProblem          &problem,
               const NewtonParameters &parameters)
  {
    NewtonResult result = NewtonIterations(x, problem, parameters).run(x);
    if (!result.converged && zero_is_better(result, problem, x))
      {
        x           = 0.;
        auto before = std::move(result.iterations);
        result      = NewtonIterations(x, problem, parameters).run(x);
        before.insert(before.end(),
                      result.iterations.begin(),
                      result.iterations.end());
        result.iterations = std::move(before);
      }
    return result;
  }
} // namespace greville

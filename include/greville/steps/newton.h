// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/compatibility.h>
#include <greville/linear_algebra/solve_result.h>
#include <greville/parameters/stage_parameters.h>

#include <string>
#include <vector>

namespace greville
{
  /// Base class of equations r(x) = 0 with forces r, N (2D: N / m), for
  /// Newton's method. All calls are collective.
  class NewtonProblem
  {
  public:
    virtual ~NewtonProblem() = default;

    /// Compute the residual at x. Returns an error message, or an empty text.
    virtual std::string
    residual(VectorType &r, const VectorType &x) = 0;

    /// Return the magnitude of the forces that add up to the last residual, N.
    virtual double
    scale() = 0;

    /// Return a smaller magnitude if scale() is an upper bound due to
    /// round-off. solve_newton() then takes one more step if the residual
    /// exceeds the tolerance times this magnitude.
    virtual double
    likely_scale()
    {
      return scale();
    }

    /// Compute the derivative at x. Returns an error message, or an empty text.
    virtual std::string
    linearize(const VectorType &x) = 0;

    /// Solve r'(x) dx = -r to a relative tolerance.
    virtual SolveResult
    solve(VectorType &dx, const VectorType &r, const double tolerance) = 0;
  };



  /// The record of an iteration; the first record belongs to the guess.
  struct NewtonIteration
  {
    /// The Euclidean norm of r, and this norm as a fraction of the scale.
    double residual = 0., relative = 0.;
    /// The fraction of dx that was taken, mostly 1; 0 marks a return to the
    /// smallest residual.
    double       step              = 0.;
    unsigned int linear_iterations = 0;
  };

  struct NewtonResult
  {
    bool                         converged = false;
    std::vector<NewtonIteration> iterations;
    /// The reason why it did not converge; empty if it did.
    std::string reason;

    unsigned int
    n_iterations() const
    {
      return iterations.empty() ? 0 : iterations.size() - 1;
    }
  };



  /**
   * Collective. Run Newton's method with full steps. A line search follows if
   * they fail, that is, if points break or if the residual does not fall below
   * the smallest one within a few steps. The line search returns to the
   * smallest residual and bisects steps as long as the residual grows. (The
   * nonmonotone steps follow the watchdog technique of @ref Chamberlain1982
   * "Chamberlain et al., 1982". Nearly incompressible bodies need them: each
   * step rotates material, which changes its volume to second order.) Linear
   * systems are solved to the relative tolerance 0.9 (|r_k| / |r_(k-1)|)^2
   * (@ref Eisenstat1996 "Eisenstat and Walker, 1996", choice 2) between the
   * parameters' bounds, so that convergence is quadratic. On entry, @p x is the
   * guess. If the method fails from this guess, and the residual at x = 0 is
   * much smaller, it starts again from x = 0.
   */
  NewtonResult
  solve_newton(VectorType             &x,
               NewtonProblem          &problem,
               const NewtonParameters &parameters);
} // namespace greville

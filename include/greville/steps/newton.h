// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_newton_h
#define greville_steps_newton_h

#include <greville/base/compatibility.h>
#include <greville/linear_algebra/solve_result.h>
#include <greville/parameters/stage_parameters.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * Equations r(x) = 0 with forces r, N (2D: N / m), that Newton's method
   * solves. All calls are collective.
   */
  class NewtonProblem
  {
  public:
    virtual ~NewtonProblem() = default;

    /**
     * The residual at x. Returns what is wrong there, empty if nothing is.
     */
    virtual std::string
    residual(VectorType &r, const VectorType &x) = 0;

    /**
     * The size of the forces that the last residual is the sum of, N.
     */
    virtual double
    scale() = 0;

    /**
     * Make the derivative at x. Returns what is wrong with it, empty if nothing
     * is.
     */
    virtual std::string
    linearize(const VectorType &x) = 0;

    /**
     * Solve r'(x) dx = -r to a relative tolerance.
     */
    virtual SolveResult
    solve(VectorType &dx, const VectorType &r, const double tolerance) = 0;
  };



  /**
   * What an iteration did; the first row is that of the guess.
   */
  struct NewtonIteration
  {
    /// Euclidean norm of r, and this norm as a fraction of the scale.
    double residual = 0., relative = 0.;
    /// The fraction of dx that was taken, 1 in most cases; 0: back to where the
    /// residual was smallest.
    double       step              = 0.;
    unsigned int linear_iterations = 0;
  };

  struct NewtonResult
  {
    bool                         converged = false;
    std::vector<NewtonIteration> iterations;
    /// Empty, or why it did not converge.
    std::string reason;

    unsigned int
    n_iterations() const
    {
      return iterations.empty() ? 0 : iterations.size() - 1;
    }
  };



  /**
   * Collective. Newton's method with full steps, and with a line search where
   * they fail: points break, or the residual does not become smaller than it
   * was in a few steps. Then it goes back to where the residual was smallest,
   * and cuts steps in halves as long as it grows. (Nonmonotone steps are those
   * of the watchdog technique of
   * @ref Chamberlain1982 "Chamberlain et al., 1982". Bodies that hardly change
   * their volume need them: each step turns them, which changes their volume to
   * second order.) Linear systems are solved to the relative tolerance 0.9
   * (|r_k| / |r_(k-1)|)^2 (@ref Eisenstat1996 "Eisenstat and Walker, 1996",
   * choice 2) between the parameters' bounds, so that convergence is quadratic.
   * On entry @p x is the guess; where that fails and the residual of zero is
   * much smaller, it begins again with zero.
   */
  NewtonResult
  solve_newton(VectorType             &x,
               NewtonProblem          &problem,
               const NewtonParameters &parameters);
} // namespace greville

#endif

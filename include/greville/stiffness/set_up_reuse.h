// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/solve_result.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace greville
{
  /// The reuse of the set-up of a preconditioner for subsequent systems, as
  /// long as it pays: until the additional iterations due to its age exceed a
  /// limit, or the cost of a set-up in one system, or a system that an older
  /// set-up makes slow takes several times this cost, or the mass factor
  /// changes by more than a factor of two.
  class SetUpReuse
  {
  public:
    /// Return whether the set-up can be used for this mass factor.
    bool
    is_possible(const double mass_factor, const double largest_excess) const
    {
      constexpr double largest_change = 2.;
      return exists && largest_excess > 0. && excess <= largest_excess &&
             last_excess <= iterations_of_set_up &&
             last_iterations <= 4. * iterations_of_set_up &&
             mass_factor <= largest_change * mass_factor_of_set_up &&
             mass_factor_of_set_up <= largest_change * mass_factor;
    }

    /// Require a new set-up.
    void
    end()
    {
      exists = false;
    }

    /// Begin with a new set-up.
    void
    begin(const double mass_factor)
    {
      static std::uint64_t last_number = 0;
      exists                           = true;
      fresh                            = true;
      unique_number                    = ++last_number;
      mass_factor_of_set_up            = mass_factor;
      excess                           = 0.;
      last_excess                      = 0.;
      last_iterations                  = 0;
      ++n;
    }

    /// Return whether no system has been solved with the set-up.
    bool
    is_fresh() const
    {
      return fresh;
    }

    /// Count the iterations of a solve.
    void
    count(const SolveResult &result)
    {
      last_iterations = *result.iterations;
      last_excess =
        std::max(0., last_iterations - digits(result) * iterations_of_digit);
      excess += last_excess;
    }

    /// Take the iterations of the first solve for comparison with later ones.
    void
    begin_count(const SolveResult &result)
    {
      iterations_of_digit = *result.iterations / digits(result);
      fresh               = *result.iterations == 0;
    }

    /// Return the number of iterations by which the first solve reduced the
    /// residual by ten.
    double
    iterations_per_digit() const
    {
      return iterations_of_digit;
    }

    /// Return the number of the set-up, which is unique on this process.
    std::uint64_t
    number() const
    {
      return unique_number;
    }

    /// Return the number of set-ups so far.
    unsigned int
    n_set_ups() const
    {
      return n;
    }

  private:
    /// Return the number of digits by which the residual decreases.
    static double
    digits(const SolveResult &result)
    {
      return std::max(0.5, -std::log10(std::max(result.reduction, 1e-16)));
    }

    /// The cost of a set-up in 3D, in iterations.
    static constexpr double iterations_of_set_up = 4.;

    bool          exists = false, fresh = false;
    double        mass_factor_of_set_up = 0.;
    double        iterations_of_digit   = 0.;
    double        excess = 0., last_excess = 0.; // iterations
    double        last_iterations = 0.;
    unsigned int  n               = 0;
    std::uint64_t unique_number   = 0;
  };
} // namespace greville

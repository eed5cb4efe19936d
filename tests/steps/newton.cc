// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks Newton's method on small systems: full steps, the watchdog, the line
// search, forcing terms, and residuals that stagnate at round-off.
#include <deal.II/lac/full_matrix.h>

#include <greville/steps/newton.h>

#include "../tests.h"
#include <algorithm>
#include <cmath>

namespace
{
  using Values = std::vector<double>;

  /// A system of one or two equations, and what Newton's method did.
  struct System
  {
    std::function<Values(const Values &x)>             residual;
    std::function<FullMatrix<double>(const Values &x)> derivative;
    double                                             scale      = 1.;
    double                                             likely     = 0.;
    NewtonParameters                                   parameters = {};

    Values       x, tolerances;
    NewtonResult result;

    static Values
    values(const VectorType &vector)
    {
      return Values(vector.begin(), vector.end());
    }

    struct Equations : NewtonProblem
    {
      explicit Equations(System &system)
        : system(system)
      {}

      std::string
      residual(VectorType &b, const VectorType &y) override
      {
        const Values result = system.residual(values(y));
        std::copy(result.begin(), result.end(), b.begin());
        return "";
      }

      double
      scale() override
      {
        return system.scale;
      }

      double
      likely_scale() override
      {
        return system.likely > 0. ? system.likely : system.scale;
      }

      std::string
      linearize(const VectorType &y) override
      {
        inverse.reinit(y.size(), y.size());
        inverse.invert(system.derivative(values(y)));
        return "";
      }

      SolveResult
      solve(VectorType       &dx,
            const VectorType &b,
            const double      tolerance) override
      {
        system.tolerances.push_back(tolerance);
        Vector<double> from(b.begin(), b.end()), to(b.size());
        inverse.vmult(to, from);
        for (unsigned int i = 0; i < b.size(); ++i)
          dx[i] = -to[i];
        SolveResult solved;
        solved.converged  = true;
        solved.iterations = 1;
        solved.reduction  = 0.;
        return solved;
      }

      System            &system;
      FullMatrix<double> inverse;
    };

    void
    solve(const Values &guess)
    {
      VectorType at(guess.size());
      std::copy(guess.begin(), guess.end(), at.begin());
      Equations problem(*this);
      result = solve_newton(at, problem, parameters);
      x      = values(at);
    }

    /// The fractions of corrections that were taken.
    Values
    steps() const
    {
      Values all;
      for (unsigned int k = 1; k < result.iterations.size(); ++k)
        all.push_back(result.iterations[k].step);
      return all;
    }
  };



  System
  scalar(const std::function<double(double)> &f,
         const std::function<double(double)> &slope)
  {
    System system;
    system.residual   = [f](const Values &x) { return Values{f(x[0])}; };
    system.derivative = [slope](const Values &x) {
      const double entry = slope(x[0]);
      return FullMatrix<double>(1, 1, &entry);
    };
    return system;
  }



  bool
  has_reason(const System &system, const std::string &words)
  {
    return !system.result.converged &&
           system.result.reason.find(words) != std::string::npos;
  }
} // namespace



void
test_main()
{
  // x^2 = 4 from 3: residuals 5, 25/36, ...
  System root = scalar([](const double x) { return x * x - 4.; },
                       [](const double x) { return 2. * x; });
  root.solve({3.});
  check("a root", root.result.converged && std::abs(root.x[0] - 2.) < 1e-8);
  check("in full steps", root.steps() == Values(4, 1.));
  check("residual of the first",
        std::abs(root.result.iterations[1].residual - 25. / 36.),
        1e-14);
  // 0.9 (r_k / r_(k-1))^2, at most 0.01: r_2 / r_1 = 0.0330.
  const auto &rows = root.result.iterations;
  check("forcing begins with the largest",
        root.tolerances[0] == 0.01 && root.tolerances[1] == 0.01);
  check("and goes with the square of the convergence",
        std::abs(root.tolerances[2] /
                   (0.9 * std::pow(rows[2].residual / rows[1].residual, 2)) -
                 1.),
        1e-12);
  // 10 (y - x^2), 1 - x from (-1.2, 1): the residual grows to ten times of what
  // it was, and vanishes with the next full step.
  System valley;
  valley.residual = [](const Values &x) {
    return Values{10. * (x[1] - x[0] * x[0]), 1. - x[0]};
  };
  valley.derivative = [](const Values &x) {
    const double entries[] = {-20. * x[0], 10., -1., 0.};
    return FullMatrix<double>(2, 2, entries);
  };
  valley.solve({-1.2, 1.});
  check("a step may lengthen the residual",
        valley.result.converged && valley.steps() == Values(2, 1.));
  check("to that of (1, -3.84)",
        std::abs(valley.result.iterations[1].residual - 48.4),
        1e-12);

  // Full steps diverge from 3: back to the guess, and a line search.
  System far = scalar([](const double x) { return std::atan(x); },
                      [](const double x) { return 1. / (1. + x * x); });
  far.solve({3.});
  const Values steps = far.steps();
  const auto   back  = std::find(steps.begin(), steps.end(), 0.);
  check("the line search converges",
        far.result.converged && std::abs(far.x[0]) < 1e-8);
  check("from where the residual was smallest",
        back != steps.end() && back[1] == 0.25 &&
          far.result.iterations[1 + (back - steps.begin())].residual ==
            std::atan(3.));

  // No step of a line search makes x^2 + 1 much smaller than one: none is taken
  // that makes it larger.
  System bowl = scalar([](const double x) { return x * x + 1.; },
                       [](const double x) { return 2. * x; });
  bowl.solve({2.});
  check("where there is no root",
        has_reason(bowl, "no step that reduces the residual"));
  bool   is_searching = false, grows = false;
  double last = 0.;
  for (const NewtonIteration &row : bowl.result.iterations)
    {
      grows        = grows || (is_searching && row.residual > last);
      is_searching = is_searching || (row.step == 0. && last > 0.);
      last         = row.residual;
    }
  check("the line search takes no step that lengthens the residual",
        is_searching && !grows);
  check("the result is the last iterate",
        std::abs(bowl.result.iterations.back().residual -
                 (bowl.x[0] * bowl.x[0] + 1.)),
        1e-14);

  // x = 1 in steps of 2e-13, so that the residual is never below 1e-13, and
  // forces of this size only.
  const auto noisy = [](const double round_off) {
    System system = scalar(
      [](const double x) {
        return 2e-13 * (std::floor((x - 1.) / 2e-13) + 0.5);
      },
      [](const double) { return 1.; });
    system.scale = round_off / system.parameters.tolerance;
    system.solve({1. + 1e-6});
    return system;
  };
  const System at_round_off = noisy(2e-13);
  check("round-off is zero",
        at_round_off.result.converged &&
          at_round_off.result.n_iterations() == 1);
  check("and no more than that", has_reason(noisy(5e-14), "did not converge"));

  // A residual below a bound of round-off, but not below the likely round-off,
  // causes one more step, also if this step does not reach it.
  const auto bounded = [](const double likely_residual) {
    System system = scalar([](const double x) { return x * x - 4.; },
                           [](const double x) { return 2. * x; });
    system.scale  = 0.1 / system.parameters.tolerance;
    system.likely = likely_residual / system.parameters.tolerance;
    system.solve({3.});
    return system;
  };
  check("no step below the likely round-off",
        bounded(0.1).result.n_iterations() == 2);
  const System further = bounded(1e-6);
  check("one more step below the bound",
        further.result.converged && further.result.n_iterations() == 3 &&
          std::abs(further.x[0] - 2.) < 2e-5);
}

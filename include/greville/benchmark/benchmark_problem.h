// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/benchmark/operators.h>
#include <greville/benchmark/problem_parameters.h>
#include <greville/boundary/constrained_functions.h>
#include <greville/paper/level_solver.h>
#include <greville/paper/mass_solver.h>

#include <memory>
#include <optional>
#include <string>

namespace greville
{
  /// A linear system with its solver, in the parts that are timed. All
  /// functions are collective.
  class BenchmarkSystem
  {
  public:
    virtual ~BenchmarkSystem() = default;

    /// Compute the matrix entries and other data of the operators.
    virtual void
    assemble() = 0;

    virtual void
    make_right_hand_side() = 0;

    /// Make transfers, smoothers and factorizations.
    virtual void
    setup() = 0;

    virtual SolveResult
    solve() = 0;

    /// Return the relative error of the solution; empty if it is unknown.
    virtual std::optional<double>
    error()
    {
      return {};
    }
  };



  /// An operator on a body and a mesh. All functions are collective.
  template <int dim>
  class BenchmarkProblem
  {
  public:
    virtual ~BenchmarkProblem() = default;

    /// Set up splines of order @p p and the levels of a coarsening, in place of
    /// earlier ones.
    virtual void
    discretize(const unsigned int p, const Coarsening coarsening) = 0;

    virtual unsigned long
    n_unknowns() const = 0;

    /// Return the number of functions per class, for extended B-splines.
    virtual typename Extension<dim>::Counts
    count_functions() const
    {
      return {};
    }

    /// Return a solver by its name, with the current p-multigrid parameters.
    virtual std::unique_ptr<BenchmarkSystem>
    make_system(const std::string          &solver,
                const PMultigridParameters &multigrid,
                const SmootherParameters   &smoother) = 0;

    /// Return the throughput of the operators; empty if it is not measured for
    /// them.
    virtual std::optional<OperatorRecord>
    throughput()
    {
      return {};
    }
  };



  /**
   * Return the names of the operators, separated by '|':
   * - "mass": M_ij = int rho N_i N_j dx or sum_p m_p N_i(x_p) N_j(x_p),
   * - "laplace": int grad N_i . grad N_j dx,
   * - "elasticity": the tangent K of a body at rest,
   * - "mass and elasticity": c M + K with c = 4 / dt^2 of a step dt.
   */
  std::string
  operator_names();

  inline bool
  is_elastic(const std::string &operator_name)
  {
    return operator_name.find("elasticity") != std::string::npos;
  }

  /// Return the names of the solvers of operators other than the mass, for the
  /// description of a parameter.
  std::string
  solvers_beside_mass();

  /// Throw dealii::ExcMessage, which names the @p parameter, if the operator
  /// does not support the solver.
  void
  check_solver(const std::string &solver,
               const std::string &operator_name,
               const std::string &parameter);

  /// Return whether the solver uses the smoother parameter.
  bool
  takes_smoother(const std::string &solver);

  /// The method and parameters of a solver of an operator other than the mass.
  struct LevelSolver
  {
    LevelMethod method             = LevelMethod::cg;
    bool        has_preconditioner = true;

    PMultigridParameters multigrid;
    SmootherParameters   smoother;
  };

  /// Return the solver by its @p name, with @p multigrid and @p smoother if it
  /// uses them. "fgmres-tielen" is the solver of @ref Tielen2020 "Tielen et
  /// al., 2020": ILUT, lumped L2 transfer between the orders one by one, and an
  /// exact solve at p = 1.
  LevelSolver
  make_level_solver(const std::string          &name,
                    const std::string          &operator_name,
                    const PMultigridParameters &multigrid,
                    const SmootherParameters   &smoother);



  /// Return fixed walls: the walls in 'Problem/Clamped walls', or, if there are
  /// none, @p all walls or else only the lower wall in the last direction.
  template <int dim>
  Walls<dim>
  clamped_walls(const ProblemParameters &parameters, const bool all)
  {
    WallParameters walls;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (parameters.clamped.empty()
            ? all || w == 2 * (dim - 1)
            : contains(parameters.clamped, WallParameters::names[w]))
        walls.type[w] = "fixed";
    return Walls<dim>(walls);
  }


  /// Return the mass problem of the density, or of a @p body of material
  /// points. All arguments are kept by reference.
  template <int dim>
  std::unique_ptr<BenchmarkProblem<dim>>
  make_mass_benchmark(const ProblemParameters       &parameters,
                      const MassSolverParameters    &solver,
                      const std::string             &body,
                      const unsigned int             n_points,
                      DistributedTriangulation<dim> &triangulation);

  /// Return the Laplace problem on the box, with zero values at clamped walls.
  /// The solution is a pseudo-random spline.
  template <int dim>
  std::unique_ptr<BenchmarkProblem<dim>>
  make_laplace_benchmark(const ProblemParameters       &parameters,
                         const SolverParameters        &solver,
                         DistributedTriangulation<dim> &triangulation);

  /// Return the problem of TangentSystem, c M + K, for a linear-elastic body at
  /// rest with a pseudo-random load: on the points of a @p body, or on p + 1
  /// Gauss points per direction in all cells if it is empty. With the Courant
  /// number C = dt sqrt((lambda + 2 G) / rho) / h for the mean density and the
  /// smallest cell side h, c = 4 / dt^2; c = 0 without a Courant number.
  template <int dim>
  std::unique_ptr<BenchmarkProblem<dim>>
  make_elastic_benchmark(const ProblemParameters       &parameters,
                         const SolverParameters        &solver,
                         const std::string             &body,
                         const unsigned int             n_points,
                         const double                   poissons_ratio,
                         const std::optional<double>   &courant_number,
                         DistributedTriangulation<dim> &triangulation);
} // namespace greville

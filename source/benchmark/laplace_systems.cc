// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/benchmark/benchmark_problem.h>
#include <greville/benchmark/laplace_level.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    class LaplaceSystems : public BenchmarkProblem<dim>
    {
    public:
      LaplaceSystems(const ProblemParameters       &problem,
                     const SolverParameters        &parameters,
                     DistributedTriangulation<dim> &triangulation)
        : walls(clamped_walls<dim>(problem, true))
        , parameters(parameters)
        , triangulation(triangulation)
      {}

      void
      discretize(const unsigned int p, const Coarsening) override
      {
        space.reset();
        space.emplace(triangulation, p);
      }

      unsigned long
      n_unknowns() const override
      {
        return space->n_dofs();
      }

      std::unique_ptr<BenchmarkSystem>
      make_system(const std::string          &name,
                  const PMultigridParameters &multigrid,
                  const SmootherParameters   &smoother) override
      {
        LevelSolver solver =
          make_level_solver(name, "laplace", multigrid, smoother);
        if (!solver.has_preconditioner)
          solver.multigrid.coarsening = Coarsening::none;
        return std::make_unique<System>(*this, solver);
      }

    private:
      class System : public BenchmarkSystem
      {
      public:
        System(const LaplaceSystems &problem, const LevelSolver &solver)
          : problem(problem)
          , solver(solver)
          , orders(problem.triangulation,
                   problem.space->degree(),
                   solver.multigrid.coarsening)
        {
          for (VectorType *vector : {&x, &b, &solution})
            orders.finest().initialize_vector(*vector);
        }

        void
        assemble() override
        {
          preconditioner.reset();
          operators.clear();
          levels.clear();
          for (unsigned int l = 0; l < orders.n_levels(); ++l)
            {
              levels.push_back(std::make_unique<LaplaceLevel<dim>>(
                orders[l],
                constrained_components_at_walls(orders[l], problem.walls)));
              operators.push_back(levels.back().get());
            }
        }

        void
        make_right_hand_side() override
        {
          // An iteration from zero then begins with an error of all
          // frequencies.
          const auto &functions = orders.finest().owned_functions();
          for (unsigned int i = 0; i < functions.size(); ++i)
            {
              const double number =
                std::sin(12.9898 * (functions[i] % 100003) + 0.7) * 43758.5453;
              solution.local_element(i) =
                2. * (number - std::floor(number)) - 1.;
            }
          for (const unsigned int i : levels.back()->inactive())
            solution.local_element(i) = 0.;
          levels.back()->vmult(b, solution);
        }

        void
        setup() override
        {
          // For p = 1, the coarse solver alone must reach the tolerance.
          if (solver.has_preconditioner)
            preconditioner = std::make_unique<PMultigrid<dim>>(
              operators,
              solver.multigrid,
              solver.smoother,
              levels.size() == 1 ? 0.5 * problem.parameters.tolerance
                                 : solver.multigrid.coarse_tolerance);
        }

        SolveResult
        solve() override
        {
          const SolverParameters &parameters = problem.parameters;
          return solve_and_check<dim>(
            *levels.back(), x, b, parameters.tolerance, [&]() {
              return iterate<dim>(solver.method,
                                  *levels.back(),
                                  preconditioner.get(),
                                  parameters,
                                  x,
                                  b);
            });
        }

        std::optional<double>
        error() override
        {
          const double norm = solution.l2_norm();
          x -= solution;
          return norm > 0. ? x.l2_norm() / norm : x.l2_norm();
        }

      private:
        const LaplaceSystems                           &problem;
        const LevelSolver                               solver;
        const OrderHierarchy<dim>                       orders;
        std::vector<std::unique_ptr<LaplaceLevel<dim>>> levels;
        typename PMultigrid<dim>::Levels                operators;
        std::unique_ptr<PMultigrid<dim>>                preconditioner;
        VectorType                                      x, b, solution;
      };

      const Walls<dim>                walls;
      const SolverParameters         &parameters;
      DistributedTriangulation<dim>  &triangulation;
      std::optional<SplineSpace<dim>> space;
    };
  } // namespace



  template <int dim>
  std::unique_ptr<BenchmarkProblem<dim>>
  make_laplace_benchmark(const ProblemParameters       &parameters,
                         const SolverParameters        &solver,
                         DistributedTriangulation<dim> &triangulation)
  {
    return std::make_unique<LaplaceSystems<dim>>(parameters,
                                                 solver,
                                                 triangulation);
  }



  GREVILLE_INSTANTIATE(make_laplace_benchmark);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/benchmark/benchmark_problem.h>
#include <greville/benchmark/mass_problem.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    class MassSystem : public BenchmarkSystem
    {
    public:
      MassSystem(MassProblem<dim>           &problem,
                 MassHierarchy<dim>         &mass,
                 const std::string          &name,
                 const MassSolverParameters &parameters,
                 const PMultigridParameters &multigrid,
                 const SmootherParameters   &smoother)
        : problem(problem)
        , mass(mass)
        , multigrid(multigrid)
        , smoother(smoother)
        , solver(name, mass, parameters, this->multigrid, this->smoother)
      {
        for (VectorType *vector : {&x, &b})
          mass.finest().space().initialize_vector(*vector);
      }

      ~MassSystem() override
      {
        for (const auto &level : mass.all_levels())
          level->clear();
      }

      void
      assemble() override
      {
        solver.assemble();
      }

      void
      make_right_hand_side() override
      {
        problem.right_hand_side(b, mass.finest());
      }

      void
      setup() override
      {
        solver.setup();
      }

      SolveResult
      solve() override
      {
        return solver.solve(x, b);
      }

      std::optional<double>
      error() override
      {
        return problem.error(x, mass.finest());
      }

    private:
      MassProblem<dim>          &problem;
      MassHierarchy<dim>        &mass;
      const PMultigridParameters multigrid;
      const SmootherParameters   smoother;
      MassSolver<dim>            solver;
      VectorType                 x, b;
    };



    template <int dim>
    class MassSystems : public BenchmarkProblem<dim>
    {
    public:
      MassSystems(std::unique_ptr<MassProblem<dim>> problem,
                  const MassSolverParameters       &parameters,
                  DistributedTriangulation<dim>    &triangulation)
        : problem(std::move(problem))
        , parameters(parameters)
        , triangulation(triangulation)
      {}

      void
      discretize(const unsigned int p, const std::string &coarsening) override
      {
        mass.reset();
        orders.reinit(triangulation, p, coarsening);
        mass = problem->make_mass(orders);
      }

      unsigned long
      n_unknowns() const override
      {
        return orders.finest().n_dofs();
      }

      typename Extension<dim>::Counts
      count_functions() const override
      {
        return problem->count_functions(orders.finest());
      }

      std::unique_ptr<BenchmarkSystem>
      make_system(const std::string          &solver,
                  const PMultigridParameters &multigrid,
                  const SmootherParameters   &smoother) override
      {
        return std::make_unique<MassSystem<dim>>(
          *problem, *mass, solver, parameters, multigrid, smoother);
      }

      std::optional<OperatorRecord>
      throughput() override
      {
        return measure_operators<dim>(mass->finest());
      }

    private:
      const std::unique_ptr<MassProblem<dim>> problem;
      const MassSolverParameters             &parameters;
      DistributedTriangulation<dim>          &triangulation;
      OrderHierarchy<dim>                     orders;
      std::unique_ptr<MassHierarchy<dim>>     mass;
    };
  } // namespace



  template <int dim>
  std::unique_ptr<BenchmarkProblem<dim>>
  make_mass_benchmark(const ProblemParameters       &parameters,
                      const MassSolverParameters    &solver,
                      const std::string             &body,
                      const unsigned int             n_points,
                      DistributedTriangulation<dim> &triangulation)
  {
    return std::make_unique<MassSystems<dim>>(
      body.empty()
        ? make_density_problem<dim>(parameters)
        : make_point_problem<dim>(parameters, body, n_points, triangulation),
      solver,
      triangulation);
  }



  template decltype(make_mass_benchmark<2>) make_mass_benchmark<2>;
  template decltype(make_mass_benchmark<3>) make_mass_benchmark<3>;
} // namespace greville

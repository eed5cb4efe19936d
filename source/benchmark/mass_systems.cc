// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/benchmark/benchmark_problem.h>
#include <greville/points/point_transfer.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Each problem has a mass matrix on all orders of a hierarchy (a MassSolver
    // makes the operators), the right-hand side M f with the acceleration f,
    // the error in the mass norm, relative to f (absolute if f is zero), and
    // for extended B-splines the number of functions per class. All functions
    // are collective.

    /// The mass M_ij = int rho N_i N_j dx, by Gauss quadrature.
    template <int dim>
    class DensityProblem
    {
    public:
      DensityProblem(const ProblemParameters &parameters)
        : density(make_function<dim>(parameters.density, "Problem/Density"))
        , acceleration(
            make_function<dim>(parameters.acceleration, "Problem/Acceleration"))
      {}

      std::unique_ptr<MassHierarchy<dim>>
      make_mass(const OrderHierarchy<dim> &orders)
      {
        return std::make_unique<MassHierarchy<dim>>(orders, *density);
      }

      void
      right_hand_side(VectorType &b, const AssembledMassLevel<dim> &level)
      {
        level.mass().cross_mass().integrate(b, *acceleration);
      }

      double
      error(const VectorType &x, const AssembledMassLevel<dim> &level)
      {
        const auto norms =
          level.mass().cross_mass().difference(x, *acceleration);
        return norms.second > 0. ? norms.first / norms.second : norms.first;
      }

      typename Extension<dim>::Counts
      count_functions(const SplineSpace<dim> &) const
      {
        return {};
      }

    private:
      const std::unique_ptr<Function<dim>> density, acceleration;
    };



    /// The mass M_ij = sum_p m_p N_i(x_p) N_j(x_p) of the material points of a
    /// body, with extended B-splines if the parameters ask for them.
    template <int dim>
    class PointProblem
    {
    public:
      PointProblem(const ProblemParameters       &p,
                   const std::string             &body,
                   const unsigned int             n,
                   DistributedTriangulation<dim> &triangulation)
        : parameters(p)
        , space(triangulation, 1)
        , filling(space)
      {
        points.reinit(space, PointLayout<dim>());
        run_on_all(space.communicator(), [&]() { make_points(body, n); });
        Require(Utilities::MPI::sum<std::uint64_t>(points.n_points(),
                                                   space.communicator()) > 0,
                "No point of the body '" + body +
                  "' has a mass: 'Problem/Density' is zero there, or "
                  "'Benchmark/Cells' are too few.");

        std::vector<double> parts(space.owned_cells().size(), 0.);
        points.for_each([&](const unsigned int cell, ConstPointRef<dim> q) {
          parts[cell] += q.volume0() / space.box(cell).volume();
        });
        filling.update(parts, parameters.filling_threshold);
      }

      std::unique_ptr<MassHierarchy<dim>>
      make_mass(const OrderHierarchy<dim> &orders)
      {
        auto mass = std::make_unique<MassHierarchy<dim>>(orders);
        for (const auto &level : mass->all_levels())
          {
            PointTransfer<dim> transfer;
            transfer.reinit(level->space());
            transfer.mass_weights({&points}, level->weights());
            if (parameters.extend)
              level->extend(Extension<dim>(level->space(), filling));
          }
        return mass;
      }

      void
      right_hand_side(VectorType &b, const AssembledMassLevel<dim> &level)
      {
        PointTransfer<dim> transfer;
        VectorType         mass;
        VectorField<dim>   momentum;
        transfer.reinit(level.space());
        level.space().initialize_vector(mass);
        for (VectorType &component : momentum)
          level.space().initialize_vector(component);
        transfer.points_to_grid({&points}, &mass, &momentum, nullptr);
        b.copy_locally_owned_data_from(momentum[0]);
        level.condense(b);
      }

      double
      error(const VectorType &x, const AssembledMassLevel<dim> &level)
      {
        PointTransfer<dim> transfer;
        VectorField<dim>   u, zero;
        transfer.reinit(level.space());
        for (VectorField<dim> *field : {&u, &zero})
          for (VectorType &component : *field)
            level.space().initialize_vector(component);
        u[0].copy_locally_owned_data_from(x);
        level.distribute(u[0]);

        // A step of length -1 yields f - u at the points.
        MaterialPoints<dim> differences = points;
        PointUpdate<dim>    update;
        update.acceleration  = &u;
        update.velocity      = &zero;
        update.velocity_step = -1.;
        transfer.grid_to_points(differences, update);

        const auto square = [&](const MaterialPoints<dim> &some) {
          double sum = 0.;
          some.for_each([&](ConstPointRef<dim> q) {
            const double v = q.velocity(0);
            sum += q.mass() * v * v;
          });
          return Utilities::MPI::sum(sum, space.communicator());
        };
        const double norm = square(points);
        return std::sqrt(square(differences) / (norm > 0. ? norm : 1.));
      }

      typename Extension<dim>::Counts
      count_functions(const SplineSpace<dim> &s) const
      {
        return parameters.extend ? Extension<dim>(s, filling).counts()
                                 : typename Extension<dim>::Counts();
      }

    private:
      void
      make_points(const std::string &body, const unsigned int n)
      {
        const auto density =
          make_function<dim>(parameters.density, "Problem/Density");
        const auto acceleration =
          make_function<dim>(parameters.acceleration, "Problem/Acceleration");
        const PointPlacement placement =
          parameters.placement<dim>(body, n, space);
        std::vector<double> numbers(points.layout().size, 0.);
        const PointRef<dim> p(numbers.data());
        p.J() = 1.;
        for (const auto &point : place_points<dim>(placement, "Problem", space))
          {
            const double rho = density->value(point.x);
            Require(rho >= 0. && std::isfinite(rho),
                    "'Problem/Density' has to be a number >= 0, but is " +
                      text_of(rho) + " at (" + text_of(point.x) + ").");
            if (rho == 0.)
              continue;
            for (unsigned int d = 0; d < dim; ++d)
              p.position(d) = point.x[d];
            p.velocity(0) = acceleration->value(point.x);
            p.mass()      = rho * point.volume;
            p.volume0()   = point.volume;
            p.id()        = double(point.id);
            points.insert(point.cell, make_array_view(numbers));
          }
      }

      const ProblemParameters &parameters;
      SplineSpace<dim>         space;  // of order 1
      MaterialPoints<dim>      points; // their velocity in x is f
      CellFilling<dim>         filling;
    };



    template <int dim, typename Problem>
    class MassSystems : public BenchmarkProblem<dim>
    {
    public:
      template <typename... Others>
      MassSystems(const MassSolverParameters    &solver,
                  DistributedTriangulation<dim> &triangulation,
                  const ProblemParameters       &parameters,
                  Others &&...others)
        : problem(parameters, others...)
        , parameters(solver)
        , triangulation(triangulation)
      {}

      void
      discretize(const unsigned int p, const Coarsening coarsening) override
      {
        mass.reset();
        orders.reinit(triangulation, p, coarsening);
        mass = problem.make_mass(orders);
      }

      unsigned long
      n_unknowns() const override
      {
        return orders.finest().n_dofs();
      }

      typename Extension<dim>::Counts
      count_functions() const override
      {
        return problem.count_functions(orders.finest());
      }

      std::unique_ptr<BenchmarkSystem>
      make_system(const std::string          &solver,
                  const PMultigridParameters &multigrid,
                  const SmootherParameters   &smoother) override
      {
        return std::make_unique<System>(*this, solver, multigrid, smoother);
      }

      std::optional<OperatorRecord>
      throughput() override
      {
        return measure_operators<dim>(mass->finest());
      }

    private:
      class System : public BenchmarkSystem
      {
      public:
        System(MassSystems                &systems,
               const std::string          &name,
               const PMultigridParameters &multigrid,
               const SmootherParameters   &smoother)
          : problem(systems.problem)
          , mass(*systems.mass)
          , multigrid(multigrid)
          , smoother(smoother)
          , solver(
              name, mass, systems.parameters, this->multigrid, this->smoother)
        {
          for (VectorType *vector : {&x, &b})
            mass.finest().space().initialize_vector(*vector);
        }

        ~System() override
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
        Problem                   &problem;
        MassHierarchy<dim>        &mass;
        const PMultigridParameters multigrid;
        const SmootherParameters   smoother;
        MassSolver<dim>            solver;
        VectorType                 x, b;
      };

      Problem                             problem;
      const MassSolverParameters         &parameters;
      DistributedTriangulation<dim>      &triangulation;
      OrderHierarchy<dim>                 orders;
      std::unique_ptr<MassHierarchy<dim>> mass;
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
    if (body.empty())
      return std::make_unique<MassSystems<dim, DensityProblem<dim>>>(
        solver, triangulation, parameters);
    return std::make_unique<MassSystems<dim, PointProblem<dim>>>(
      solver, triangulation, parameters, body, n_points, triangulation);
  }



  GREVILLE_INSTANTIATE(make_mass_benchmark);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/benchmark/benchmark_problem.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    std::unique_ptr<Material>
    make_elastic(const double poissons_ratio)
    {
      auto             material = make_material("linear-elastic", "Material");
      ParameterHandler prm;
      material->declare(prm);
      prm.set("Density", 1.);
      prm.set("Young modulus", 1.);
      prm.set("Poisson ratio", poissons_ratio);
      material->reinit("Benchmark");
      return material;
    }



    template <int dim>
    class ElasticSystems : public BenchmarkProblem<dim>
    {
    public:
      ElasticSystems(const ProblemParameters       &problem,
                     const SolverParameters        &parameters,
                     const std::string             &name,
                     const unsigned int             n_points,
                     const double                   poissons_ratio,
                     const std::optional<double>   &courant_number,
                     DistributedTriangulation<dim> &triangulation)
        : problem(problem)
        , parameters(parameters)
        , walls(clamped_walls<dim>(problem, false))
        , material(make_elastic(poissons_ratio))
        , courant_number(courant_number)
        , triangulation(triangulation)
        , is_box(name.empty())
        , space(triangulation, 1)
      {
        body.name     = is_box ? "box" : name;
        body.material = material.get();
        if (!is_box)
          make_points(problem.placement<dim>(name, n_points, space));
      }

      void
      discretize(const unsigned int p, const Coarsening) override
      {
        degree = p;
        if (is_box)
          {
            PointPlacement placement =
              problem.placement<dim>("box", p + 1, space);
            placement.placement = Placement::gauss;
            placement.jitter    = 0.;
            make_points(placement);
          }

        // The functions that TangentSystem takes.
        const double        filling_threshold = threshold();
        std::vector<double> parts(space.owned_cells().size(), 0.);
        body.points.for_each(
          [&](const unsigned int cell, ConstPointRef<dim> q) {
            parts[cell] += q.volume0() / space.box(cell).volume();
          });
        CellFilling<dim> filling(space);
        filling.update(parts, filling_threshold);
        counts =
          Extension<dim>(SplineSpace<dim>(triangulation, p), filling).counts();
      }

      unsigned long
      n_unknowns() const override
      {
        return dim * (counts.stable + counts.lumped);
      }

      typename Extension<dim>::Counts
      count_functions() const override
      {
        return is_box ? typename Extension<dim>::Counts() : counts;
      }

      std::unique_ptr<BenchmarkSystem>
      make_system(const std::string          &name,
                  const PMultigridParameters &multigrid,
                  const SmootherParameters   &smoother) override
      {
        const LevelSolver solver =
          make_level_solver(name, "elasticity", multigrid, smoother);
        TangentParameters tangent;
        tangent.method         = solver.method == LevelMethod::fgmres
                                   ? TangentParameters::Method::fgmres
                                   : TangentParameters::Method::cg;
        tangent.use_of_levels  = solver.multigrid.has_coarse_levels()
                                   ? TangentParameters::UseOfLevels::always
                                   : TangentParameters::UseOfLevels::never;
        tangent.max_iterations = parameters.max_iterations;
        tangent.multigrid      = solver.multigrid;
        tangent.smoother       = solver.smoother;
        return std::make_unique<System>(*this, tangent);
      }

    private:
      class System : public BenchmarkSystem
      {
      public:
        System(const ElasticSystems &problem, const TangentParameters &tangent)
          : problem(problem)
          , tangent(tangent)
          , orders(problem.triangulation,
                   problem.degree,
                   tangent.multigrid.coarsening)
          , system(
              orders,
              [&](const SplineSpace<dim> &space) {
                return constrained_components_at_walls(space, problem.walls);
              },
              this->tangent,
              problem.threshold(),
              false)
        {
          for (auto *field : {&u, &force})
            for (VectorType &component : *field)
              system.space().initialize_vector(component);
        }

        void
        assemble() override
        {
          system.set_points(problem.bodies);
          for (VectorType &component : u)
            component = 0.;
          throw_on_all(system.evaluate(
                         problem.bodies, u, 1., StepStress::end, true, force),
                       system.space().communicator());
        }

        void
        make_right_hand_side() override
        {
          for (VectorType *vector : {&x, &b})
            system.initialize(*vector);
          const auto &owned = system.space().owned_functions();
          const auto &functions =
            system.finest().extended().unknowns().unknown_functions();
          for (unsigned int i = 0; i < functions.size(); ++i)
            for (unsigned int c = 0; c < dim; ++c)
              b.local_element(i * dim + c) =
                std::sin(12.9898 * ((owned[functions[i]] + 1) % 104729) + c);
          system.finest().extended().unknowns().zero_constrained_unknowns(b,
                                                                          dim);
          system.extend(u, b);
          system.restrict(b, u, nullptr);
        }

        void
        setup() override
        {
          system.forget();
          system.set_operator(problem.mass_factor, true);
        }

        SolveResult
        solve() override
        {
          const double tolerance = problem.parameters.tolerance;
          const auto   multiply  = [&](VectorType &dst, const VectorType &src) {
            system.multiply(dst, src);
          };
          return solve_and_check(multiply, x, b, tolerance, [&]() {
            return system.solve(x, b, tolerance);
          });
        }

      private:
        const ElasticSystems     &problem;
        const TangentParameters   tangent;
        const OrderHierarchy<dim> orders;
        TangentSystem<dim>        system;
        VectorField<dim>          u, force;
        VectorType                x, b;
      };

      /// Return the filling threshold. It is 0 for a box, whose B-splines use
      /// all cells.
      double
      threshold() const
      {
        return is_box || !problem.extend ? 0. : problem.filling_threshold;
      }

      void
      make_points(const PointPlacement &placement)
      {
        BodyParameters body_parameters;
        static_cast<PointPlacement &>(body_parameters) = placement;
        body.parameters                                = &body_parameters;
        greville::make_points(body,
                              space,
                              Tensor<1, dim>(),
                              PointLayout<dim>(material->state_names()));
        body.parameters = nullptr;

        const auto density =
          make_function<dim>(problem.density, "Problem/Density");
        std::vector<double> sums(2); // mass, volume
        run_on_all(space.communicator(), [&]() {
          body.points.for_each([&](PointRef<dim> q) {
            const Point<dim> x   = q.position();
            const double     rho = density->value(x);
            Require(rho >= 0. && std::isfinite(rho),
                    "'Problem/Density' has to be a number >= 0, but is " +
                      text_of(rho) + " at (" + text_of(x) + ").");
            q.mass() = rho * q.volume0();
            sums[0] += q.mass();
            sums[1] += q.volume0();
          });
        });
        Utilities::MPI::sum(sums, space.communicator(), sums);
        Require(sums[0] > 0.,
                "'Problem/Density' is zero at all points: there is no mass.");
        set_mass_factor(sums[0] / sums[1]);
        bodies = {{&body.points, body.material, body.name, 1.}};
      }

      void
      set_mass_factor(const double density)
      {
        mass_factor = 0.;
        if (!courant_number)
          return;
        const double h      = space.smallest_cell_size();
        const Moduli moduli = material->moduli();
        const double c =
          std::sqrt((moduli.bulk + 4. / 3. * moduli.shear) / density);
        mass_factor = 4. / std::pow(*courant_number * h / c, 2);
      }

      const ProblemParameters        &problem;
      const SolverParameters         &parameters;
      const Walls<dim>                walls;
      const std::unique_ptr<Material> material;
      const std::optional<double>     courant_number;
      DistributedTriangulation<dim>  &triangulation;
      const bool                      is_box;
      const SplineSpace<dim>          space; // of order 1
      Body<dim>                       body;
      std::vector<TrialBody<dim>>     bodies;
      double                          mass_factor = 0.;
      unsigned int                    degree      = 1;

      typename Extension<dim>::Counts counts;
    };
  } // namespace



  template <int dim>
  std::unique_ptr<BenchmarkProblem<dim>>
  make_elastic_benchmark(const ProblemParameters       &parameters,
                         const SolverParameters        &solver,
                         const std::string             &body,
                         const unsigned int             n_points,
                         const double                   poissons_ratio,
                         const std::optional<double>   &courant_number,
                         DistributedTriangulation<dim> &triangulation)
  {
    return std::make_unique<ElasticSystems<dim>>(parameters,
                                                 solver,
                                                 body,
                                                 n_points,
                                                 poissons_ratio,
                                                 courant_number,
                                                 triangulation);
  }



  GREVILLE_INSTANTIATE(make_elastic_benchmark);
} // namespace greville

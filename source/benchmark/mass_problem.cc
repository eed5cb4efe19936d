// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/benchmark/mass_problem.h>
#include <greville/points/material_points.h>
#include <greville/points/point_transfer.h>

#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    class DensityProblem : public MassProblem<dim>
    {
    public:
      DensityProblem(const ProblemParameters &parameters)
        : density(make_function<dim>(parameters.density, "Problem/Density"))
        , acceleration(
            make_function<dim>(parameters.acceleration, "Problem/Acceleration"))
      {}

      std::unique_ptr<MassHierarchy<dim>>
      make_mass(const OrderHierarchy<dim> &orders) override
      {
        return std::make_unique<MassHierarchy<dim>>(orders, *density);
      }

      void
      right_hand_side(VectorType                    &b,
                      const AssembledMassLevel<dim> &level) override
      {
        level.mass().cross_mass().integrate(b, *acceleration);
      }

      double
      error(const VectorType &x, const AssembledMassLevel<dim> &level) override
      {
        const auto norms =
          level.mass().cross_mass().difference(x, *acceleration);
        return norms.second > 0. ? norms.first / norms.second : norms.first;
      }

      typename Extension<dim>::Counts
      count_functions(const SplineSpace<dim> &) const override
      {
        return {};
      }

    private:
      const std::unique_ptr<Function<dim>> density, acceleration;
    };



    template <int dim>
    class PointProblem : public MassProblem<dim>
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
        run_on_all([&]() { make_points(body, n); }, space.communicator());
        AssertThrow(
          Utilities::MPI::sum<std::uint64_t>(points.n_points(),
                                             space.communicator()) > 0,
          ExcMessage("No point of the body '" + body +
                     "' has a mass: 'Problem/Density' is zero there, or "
                     "'Benchmark/Cells' are too few."));

        const double        cell_volume = space.lattice().cell_volume();
        std::vector<double> parts(space.owned_cells().size(), 0.);
        points.for_each([&](const unsigned int cell, ConstPointRef<dim> q) {
          parts[cell] += q.volume0() / cell_volume;
        });
        filling.update(parts, parameters.filling_threshold);
      }

      std::unique_ptr<MassHierarchy<dim>>
      make_mass(const OrderHierarchy<dim> &orders) override
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
      right_hand_side(VectorType                    &b,
                      const AssembledMassLevel<dim> &level) override
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
      error(const VectorType &x, const AssembledMassLevel<dim> &level) override
      {
        PointTransfer<dim> transfer;
        VectorField<dim>   u, zero;
        transfer.reinit(level.space());
        for (VectorField<dim> *field : {&u, &zero})
          for (VectorType &component : *field)
            level.space().initialize_vector(component);
        u[0].copy_locally_owned_data_from(x);
        level.distribute(u[0]);

        // A step of length -1 leaves f - u at the points.
        MaterialPoints<dim> differences = points;
        PointUpdate<dim>    update;
        update.acceleration  = &u;
        update.velocity      = &zero;
        update.velocity_step = -1.;
        transfer.grid_to_points(differences, update);

        const auto square = [&](const MaterialPoints<dim> &some) {
          double sum = 0.;
          some.for_each([&](const unsigned int, ConstPointRef<dim> q) {
            const double v = q.velocity(0);
            sum += q.mass() * v * v;
          });
          return Utilities::MPI::sum(sum, space.communicator());
        };
        const double norm = square(points);
        return std::sqrt(square(differences) / (norm > 0. ? norm : 1.));
      }

      typename Extension<dim>::Counts
      count_functions(const SplineSpace<dim> &s) const override
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
          parameters.placement<dim>(body, n, space.lattice());
        std::vector<double> numbers(points.layout().size, 0.);
        const PointRef<dim> p(numbers.data());
        p.J() = 1.;
        for (const auto &point : place_points<dim>(placement, "Problem", space))
          {
            const double rho = density->value(point.x);
            if (!(rho >= 0. && std::isfinite(rho)))
              {
                std::ostringstream text;
                text << "'Problem/Density' has to be a number >= 0, but is "
                     << rho << " at (" << point.x << ").";
                AssertThrow(false, ExcMessage(text.str()));
              }
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
  } // namespace



  template <int dim>
  std::unique_ptr<MassProblem<dim>>
  make_density_problem(const ProblemParameters &parameters)
  {
    return std::make_unique<DensityProblem<dim>>(parameters);
  }



  template <int dim>
  std::unique_ptr<MassProblem<dim>>
  make_point_problem(const ProblemParameters       &parameters,
                     const std::string             &body,
                     const unsigned int             n,
                     DistributedTriangulation<dim> &triangulation)
  {
    return std::make_unique<PointProblem<dim>>(parameters,
                                               body,
                                               n,
                                               triangulation);
  }



#define INSTANTIATE(dim)                                                \
  template std::unique_ptr<MassProblem<dim>> make_density_problem<dim>( \
    const ProblemParameters &);                                         \
  template std::unique_ptr<MassProblem<dim>> make_point_problem(        \
    const ProblemParameters &,                                          \
    const std::string &,                                                \
    const unsigned int,                                                 \
    DistributedTriangulation<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/benchmark/mass_problem.h>
#include <greville/particles/body.h>
#include <greville/particles/material_points.h>
#include <greville/particles/point_transfer.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace greville
{
  using namespace dealii;

  void
  MassProblemParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Lower corner",
                      lower,
                      "Corner of the box with the smallest coordinates; 2D "
                      "takes the first two. Unit: m.",
                      Patterns::List(Patterns::Double(), 2, 3));
    prm.add_parameter("Upper corner",
                      upper,
                      "Corner with the largest coordinates. Unit: m.",
                      Patterns::List(Patterns::Double(), 2, 3));
    prm.add_parameter("Cell ratio",
                      cell_ratio,
                      "The box has this multiple of the number of cells in "
                      "each direction. Unit: none.",
                      Patterns::List(Patterns::Integer(1), 2, 3));
    prm.add_parameter("Density",
                      density,
                      "Density as an expression of x, y, z; not negative, zero "
                      "in holes, as in if(x<0.5,1,0). Unit: kg/m^dim.");
    prm.add_parameter(
      "Acceleration",
      acceleration,
      "The force is density times this expression of x, y, z, which is then "
      "the solution, up to its projection. Unit: m/s^2.");
    prm.add_parameter(
      "Points",
      bodies,
      "Bodies of material points with this density, one after the other: box "
      "fills the grid, column stands on the floor (the lower wall in the last "
      "direction) away from all other walls, disk (2D) and ball (3D) are "
      "round, in the middle, and touch no wall. Empty: the density itself, "
      "without points.",
      Patterns::List(Patterns::Selection("box|column|disk|ball"), 0));
    prm.add_parameter("Points per direction",
                      points_per_direction,
                      "Material points per cell in each direction; several "
                      "numbers one after the other. Unit: none.",
                      Patterns::List(Patterns::Integer(2, 4), 1));
    prm.add_parameter(
      "Jitter",
      jitter,
      "Each material point is moved at random by at most this part of half the "
      "distance between points; 0: a lattice. Unit: none.",
      Patterns::Double(0., 1.));
    prm.add_parameter(
      "Filling threshold",
      filling_threshold,
      "Cells of which material points fill this part are well-filled. "
      "B-splines without a cell that is surrounded by such cells are extended "
      "from those with one; 0: all cells with points count. Unit: none.",
      Patterns::Double(0.));
    prm.add_parameter("Extension",
                      extend,
                      "Extended B-splines for material points; without, the "
                      "matrix of all functions that see a point.");
  }



  void
  MassProblemParameters::check(const unsigned int dim) const
  {
    AssertThrow(lower.size() >= dim && upper.size() >= dim &&
                  cell_ratio.size() >= dim,
                ExcMessage("'Problem/Lower corner', 'Problem/Upper corner' and "
                           "'Problem/Cell ratio' need " +
                           std::to_string(dim) + " numbers in " +
                           std::to_string(dim) + "D."));
    for (unsigned int d = 0; d < dim; ++d)
      AssertThrow(lower[d] < upper[d],
                  ExcMessage("'Problem/Lower corner' has to be below "
                             "'Problem/Upper corner' in each direction."));
    const std::string names = dim == 2 ? "box|column|disk" : "box|column|ball";
    for (const std::string &body : bodies)
      AssertThrow(names.find(body) != std::string::npos,
                  ExcMessage("The parameter 'Problem/Points' is <" + body +
                             ">; it has to be one of " + names + " in " +
                             std::to_string(dim) +
                             "D (see 'Benchmark/Dimensions')."));
  }



  namespace
  {
    template <int dim>
    class DensityProblem : public MassProblem<dim>
    {
    public:
      DensityProblem(const MassProblemParameters &parameters)
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
      right_hand_side(VectorType &b, const MassLevel<dim> &level) override
      {
        level.mass().cross_mass().integrate(b, *acceleration);
      }

      double
      error(const VectorType &x, const MassLevel<dim> &level) override
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



    /**
     * A body as a formula of Shape. Its surfaces cut cells.
     */
    template <int dim>
    std::string
    shape_of(const std::string &body, const Lattice<dim> &lattice)
    {
      std::ostringstream formula;
      formula << std::setprecision(17);
      const auto at = [&](const unsigned int d, const double part) {
        return lattice.lower(d) + part * (lattice.upper(d) - lattice.lower(d));
      };
      if (body == "disk" || body == "ball")
        {
          double width = lattice.upper(0) - lattice.lower(0);
          formula << "ball(";
          for (unsigned int d = 0; d < dim; ++d)
            {
              formula << at(d, 0.5) << ", ";
              width = std::min(width, lattice.upper(d) - lattice.lower(d));
            }
          formula << 0.4 * width << ")";
        }
      else
        {
          formula << "box(";
          for (const bool upper : {false, true})
            for (unsigned int d = 0; d < dim; ++d)
              {
                double part = upper;
                if (body == "column")
                  part =
                    d + 1 < dim ? (upper ? 0.77 : 0.23) : (upper ? 0.67 : 0.);
                formula << (upper || d > 0 ? ", " : "") << at(d, part);
              }
          formula << ")";
        }
      return formula.str();
    }



    template <int dim>
    class PointProblem : public MassProblem<dim>
    {
    public:
      PointProblem(const MassProblemParameters   &p,
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

        double cell_volume = 1.;
        for (unsigned int d = 0; d < dim; ++d)
          cell_volume *= space.lattice().cell_size(d);
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
      right_hand_side(VectorType &b, const MassLevel<dim> &level) override
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
      error(const VectorType &x, const MassLevel<dim> &level) override
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
        PointPlacement placement;
        placement.shape                = shape_of(body, space.lattice());
        placement.points_per_direction = {n};
        placement.jitter               = parameters.jitter;

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

      const MassProblemParameters &parameters;
      SplineSpace<dim>             space;  // of order 1
      MaterialPoints<dim>          points; // their velocity in x is f
      CellFilling<dim>             filling;
    };
  } // namespace



  template <int dim>
  std::unique_ptr<MassProblem<dim>>
  make_density_problem(const MassProblemParameters &parameters)
  {
    return std::make_unique<DensityProblem<dim>>(parameters);
  }



  template <int dim>
  std::unique_ptr<MassProblem<dim>>
  make_point_problem(const MassProblemParameters   &parameters,
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
    const MassProblemParameters &);                                     \
  template std::unique_ptr<MassProblem<dim>> make_point_problem(        \
    const MassProblemParameters &,                                      \
    const std::string &,                                                \
    const unsigned int,                                                 \
    DistributedTriangulation<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
} // namespace greville

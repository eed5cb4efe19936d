#include <greville/simulation/loads.h>

#include <algorithm>
#include <limits>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::vector<std::string>
    load_variables()
    {
      return dim == 2
               ? std::vector<std::string>{"x", "y", "X", "Y", "t"}
               : std::vector<std::string>{"x", "y", "z", "X", "Y", "Z", "t"};
    }



    // Loads that move a point by more than this part of a cell in a step can be
    // why a step fails.
    constexpr double large_move = 0.1;



    /**
     * The parameters of the loads that there are.
     */
    std::string
    names_of_loads(const SimulationParameters &parameters,
                   const bool                  with_gravity)
    {
      std::string result;
      const auto  add = [&](const std::string &name) {
        result += (result.empty() ? "" : ", ") + name;
      };
      if (with_gravity && !parameters.loads.gravity.empty())
        add("'Loads/Gravity'");
      if (!parameters.loads.body_force.empty())
        add("'Loads/Body force'");
      for (const std::string &name : parameters.general.tractions)
        add("'Traction " + name + "/Traction' with 'Traction " + name +
            "/Area'");
      return result;
    }



    template <int dim>
    std::string
    too_large(const SimulationParameters &parameters,
              const Point<dim>           &X,
              const double                t)
    {
      std::ostringstream message;
      message << "the point of the initial position (" << X
              << ") m gets more than 1e100 m / s^2 at t = " << t << " s from "
              << names_of_loads(parameters, false);
      return message.str();
    }



    /**
     * Collective. The message where no point is in the shape of a traction.
     */
    template <int dim>
    std::string
    no_point(const std::string            &section,
             const std::string            &shape,
             const std::vector<Body<dim>> &bodies,
             const MPI_Comm                comm)
    {
      Point<dim> lower, upper;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] = std::numeric_limits<double>::max();
          upper[d] = std::numeric_limits<double>::lowest();
          for (const Body<dim> &body : bodies)
            {
              body.points.for_each(
                [&](const unsigned int, ConstPointRef<dim> p) {
                  const double X = p.reference(d);
                  lower[d]       = std::min(lower[d], X);
                  upper[d]       = std::max(upper[d], X);
                });
            }
          lower[d] = Utilities::MPI::min(lower[d], comm);
          upper[d] = Utilities::MPI::max(upper[d], comm);
        }
      std::ostringstream message;
      message << "The parameter '" << section << "/Shape' is <" << shape
              << ">: no point is in it. Points are between (" << lower
              << ") m and (" << upper << ") m initially. Where they are comes "
              << "from 'Grid/Cells'";
      for (const Body<dim> &body : bodies)
        message << ", 'Body " << body.name
                << (body.parameters->points_file.empty()
                      ? "/Points per direction'"
                      : "/Points file'");
      message << ".";
      return message.str();
    }
  } // namespace



  template <int dim>
  Loads<dim>::Loads(const SimulationParameters &parameters)
    : parameters(parameters)
  {
    if (!parameters.loads.gravity.empty())
      gravity_formulas =
        make_expressions(parameters.loads.gravity, "Loads/Gravity", {"t"}, dim);
    if (!parameters.loads.body_force.empty())
      body_force = make_expressions(parameters.loads.body_force,
                                    "Loads/Body force",
                                    load_variables<dim>(),
                                    dim);
  }



  template <int dim>
  bool
  Loads<dim>::act_on_points() const
  {
    return !body_force.empty() || !parameters.tractions.empty();
  }



  template <int dim>
  void
  Loads<dim>::find_surfaces(const std::vector<Body<dim>> &bodies,
                            const MPI_Comm                comm)
  {
    for (const std::string &name : parameters.general.tractions)
      {
        const TractionParameters &given   = parameters.tractions.at(name);
        const std::string         section = "Traction " + name;
        Traction traction{Shape<dim>(given.shape, section + "/Shape"),
                          make_expressions(given.traction,
                                           section + "/Traction",
                                           load_variables<dim>(),
                                           dim),
                          0.};
        double   volume = 0.;
        for (const Body<dim> &body : bodies)
          {
            body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
              if (traction.shape.contains(p.reference()))
                volume += p.volume0();
            });
          }
        volume = Utilities::MPI::sum(volume, comm);
        AssertThrow(volume > 0.,
                    ExcMessage(
                      no_point<dim>(section, given.shape, bodies, comm)));
        traction.area_per_volume0 = given.area / volume;
        tractions.push_back(std::move(traction));
      }
  }



  template <int dim>
  std::string
  Loads<dim>::what_is_large(const double   t,
                            const double   dt,
                            const double   h,
                            const MPI_Comm comm) const
  {
    const double most = Utilities::MPI::max(largest, comm) + gravity(t).norm();
    if (!(most * dt * dt > large_move * h))
      return "";
    std::ostringstream message;
    message << "Loads alone accelerate points by up to " << most
            << " m / s^2, which moves them by " << most * dt * dt / h
            << " cells in a step: " << names_of_loads(parameters, true) << ". ";
    return message.str();
  }



  template <int dim>
  Tensor<1, dim>
  Loads<dim>::gravity(const double at_time) const
  {
    Tensor<1, dim> result;
    for (unsigned int d = 0; d < gravity_formulas.size(); ++d)
      result[d] = gravity_formulas[d](ArrayView<const double>(&at_time, 1));
    return result;
  }



  template <int dim>
  void
  Loads<dim>::set(std::vector<Body<dim>> &bodies, const double t)
  {
    largest = 0.;
    if (body_force.empty() && tractions.empty())
      return;
    for (Body<dim> &body : bodies)
      {
        const unsigned int load = body.points.layout().load;
        body.points.for_each([&](const unsigned int, PointRef<dim> p) {
          double           arguments[2 * dim + 1];
          const Point<dim> X = p.reference();
          for (unsigned int d = 0; d < dim; ++d)
            {
              arguments[d]       = p.position(d);
              arguments[dim + d] = X[d];
            }
          arguments[2 * dim] = t;
          const ArrayView<const double> view(arguments, 2 * dim + 1);
          Tensor<1, dim>                sum;
          for (unsigned int d = 0; d < body_force.size(); ++d)
            sum[d] = body_force[d](view);
          for (const Traction &traction : tractions)
            if (traction.shape.contains(X))
              for (unsigned int d = 0; d < dim; ++d)
                sum[d] += traction.formulas[d](view) *
                          traction.area_per_volume0 * p.volume0() / p.mass();
          AssertThrow(sum.norm() <= 1e100,
                      ExcMessage(too_large(parameters, X, t)));
          if (body.imposed_velocity.empty())
            largest = std::max(largest, sum.norm());
          for (unsigned int d = 0; d < dim; ++d)
            p[load + d] = sum[d];
        });
      }
  }



  template class Loads<2>;
  template class Loads<3>;
} // namespace greville

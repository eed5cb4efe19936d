#include <greville/simulation/loads.h>

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



    template <int dim>
    std::string
    too_large(const SimulationParameters &parameters,
              const Point<dim>           &X,
              const double                t)
    {
      std::ostringstream message;
      message << "'Loads/Body force'";
      for (const std::string &name : parameters.general.tractions)
        message << ", 'Traction " << name << "/Traction' with its 'Area'";
      message << " together give the point of the initial position (" << X
              << ") m more than 1e100 m / s^2 at t = " << t << " s";
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
    using Layout = PointLayout<dim>;
    for (const std::string &name : parameters.general.tractions)
      {
        const TractionParameters &given   = *parameters.tractions.at(name);
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
            const unsigned int s = body.points.stride();
            body.points.for_each([&](const unsigned int, const double *p) {
              Point<dim> X;
              for (unsigned int d = 0; d < dim; ++d)
                X[d] = p[(Layout::reference + d) * s];
              if (traction.shape.contains(X))
                volume += p[Layout::volume0 * s];
            });
          }
        volume = Utilities::MPI::sum(volume, comm);
        AssertThrow(volume > 0.,
                    ExcMessage("The parameter '" + section + "/Shape' is <" +
                               given.shape + ">: no point is in it."));
        traction.area_per_volume0 = given.area / volume;
        tractions.push_back(std::move(traction));
      }
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
  Loads<dim>::set(std::vector<Body<dim>> &bodies, const double t) const
  {
    using Layout = PointLayout<dim>;
    if (body_force.empty() && tractions.empty())
      return;
    for (Body<dim> &body : bodies)
      {
        const unsigned int s    = body.points.stride();
        const unsigned int load = body.points.layout().load;
        body.points.for_each([&](const unsigned int, double *p) {
          double     arguments[2 * dim + 1];
          Point<dim> X;
          for (unsigned int d = 0; d < dim; ++d)
            {
              arguments[d]       = p[(Layout::position + d) * s];
              arguments[dim + d] = p[(Layout::reference + d) * s];
              X[d]               = arguments[dim + d];
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
                          traction.area_per_volume0 * p[Layout::volume0 * s] /
                          p[Layout::mass * s];
          AssertThrow(sum.norm() <= 1e100,
                      ExcMessage(too_large(parameters, X, t)));
          for (unsigned int d = 0; d < dim; ++d)
            p[(load + d) * s] = sum[d];
        });
      }
  }



  template class Loads<2>;
  template class Loads<3>;
} // namespace greville

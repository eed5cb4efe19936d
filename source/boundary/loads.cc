// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/boundary/body_force.h>
#include <greville/boundary/loads.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Loads that move a point by more than this fraction of a cell in a step
    // are a possible reason for a failed step.
    constexpr double suspicious_move = 0.1;



    // The list of all kinds of point loads, one line each.
    template <int dim>
    std::vector<MakePointLoads<dim>> &
    kinds_of_point_loads()
    {
      static std::vector<MakePointLoads<dim>> list = {BodyForce<dim>::make};
      return list;
    }
  } // namespace



  template <int dim>
  void
  add_point_load(const MakePointLoads<dim> &make)
  {
    kinds_of_point_loads<dim>().push_back(make);
  }



  template <int dim>
  Loads<dim>::Loads(const SimulationParameters &parameters)
    : surface_loads(parameters)
  {
    if (!parameters.loads.gravity.empty())
      gravity_formulas = {parameters.loads.gravity, "Loads/Gravity", {"t"}};
    for (const auto &make : kinds_of_point_loads<dim>())
      for (auto &load : make(parameters))
        point_loads.push_back(std::move(load));
  }



  template <int dim>
  void
  Loads<dim>::add_fields(PointLayout<dim> &layout) const
  {
    if (act_on_points())
      layout.add("load", dim);
    for (const auto &load : point_loads)
      load->add_fields(layout);
  }



  template <int dim>
  void
  Loads<dim>::find_points(std::vector<Body<dim>> &bodies,
                          const MPI_Comm          comm) const
  {
    for (const auto &load : point_loads)
      load->find_points(bodies, comm);
    precompute(bodies);
  }



  template <int dim>
  void
  Loads<dim>::precompute(std::vector<Body<dim>> &bodies) const
  {
    for (const auto &load : point_loads)
      for (Body<dim> &body : bodies)
        load->precompute(body.points);
  }



  template <int dim>
  std::string
  Loads<dim>::names(const bool with_gravity) const
  {
    std::string result =
      with_gravity && !gravity_formulas.is_zero() ? "'Loads/Gravity'" : "";
    for (const auto &load : point_loads)
      result += (result.empty() ? "" : ", ") + load->parameter_names();
    return result;
  }



  template <int dim>
  std::string
  Loads<dim>::describe_large_loads(const double   t,
                                   const double   dt,
                                   const double   h,
                                   const MPI_Comm comm) const
  {
    const double largest_acceleration =
      Utilities::MPI::max(largest, comm) + gravity(t).norm();
    if (!(largest_acceleration * dt * dt > suspicious_move * h))
      return "";
    std::ostringstream message;
    message << "Loads alone accelerate points by up to " << largest_acceleration
            << " m / s^2, which moves them by "
            << largest_acceleration * dt * dt / h
            << " cells in a step: " << names(true) << ". ";
    return message.str();
  }



  template <int dim>
  Tensor<1, dim>
  Loads<dim>::gravity(const double t) const
  {
    try
      {
        return gravity_formulas(t);
      }
    catch (const ExcMessage &error)
      {
        throw ErrorOnAll(message_of(error));
      }
  }



  template <int dim>
  void
  Loads<dim>::clear(std::vector<Body<dim>> &bodies) const
  {
    // Another stage may have had loads.
    for (Body<dim> &body : bodies)
      if (const PointField *load = body.points.layout().find("load"))
        body.points.for_each([&](PointRef<dim> p) {
          for (unsigned int d = 0; d < dim; ++d)
            p[load->first + d] = 0.;
        });
  }



  template <int dim>
  void
  Loads<dim>::set(std::vector<Body<dim>> &bodies,
                  const double            t,
                  const bool              with_following)
  {
    if (with_following)
      largest = 0.;
    if (!act_on_points())
      return;
    clear(bodies);
    for (Body<dim> &body : bodies)
      {
        const unsigned int first = body.points.layout().first("load");
        for (const auto &load : point_loads)
          if (with_following || !load->at_position(body.points.layout(), t))
            load->add_acceleration(body.points, first, t);
        body.points.for_each([&](ConstPointRef<dim> p) {
          const double size = p.vector(first).norm();
          if (!(size <= 1e100))
            {
              std::ostringstream message;
              message << "the load on the point with the initial position ("
                      << p.reference()
                      << ") m is more than 1e100 m / s^2 at t = " << t
                      << " s from " << names(false);
              Require(false, message.str());
            }
          largest = std::max(largest, size);
        });
      }
  }



  template <int dim>
  std::vector<LoadedSurface<dim>>
  Loads<dim>::following(const std::vector<Body<dim>> &bodies,
                        const double                  t) const
  {
    std::vector<LoadedSurface<dim>> result;
    for (const Body<dim> &body : bodies)
      {
        std::vector<typename PointLoad<dim>::AtPosition> accelerations;
        for (const auto &load : point_loads)
          if (auto acceleration = load->at_position(body.points.layout(), t))
            accelerations.push_back(std::move(acceleration));
        if (!accelerations.empty())
          result.push_back({&body.points,
                            [accelerations](const ConstPointRef<dim> p,
                                            const SurfaceState<dim> &state) {
                              Tensor<1, dim> sum;
                              for (const auto &acceleration : accelerations)
                                sum += acceleration(p, state.x);
                              return sum;
                            }});
      }
    return result;
  }



  GREVILLE_INSTANTIATE(add_point_load);
  GREVILLE_INSTANTIATE_CLASS(Loads);
} // namespace greville

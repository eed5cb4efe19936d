// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/contact/rigid_body.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Points face a rigid surface where the cosine of the angle between normals
    // is below this.
    constexpr double facing = 0.;

    // The part of a second over which the spin is a difference quotient.
    constexpr double moment = 1e-6;
  } // namespace



  template <int dim>
  RigidBody<dim>::RigidBody(const std::string         &name,
                            const RigidBodyParameters &parameters)
    : body_name(name)
  {
    const std::string section = "Rigid body " + name;
    for (unsigned int d = 0; d < parameters.reference_point.size(); ++d)
      reference[d] = parameters.reference_point[d];
    surface =
      parameters.shape_file.empty()
        ? make_closest_surface<dim>(parameters.shape, section + "/Shape")
        : make_closest_surface<dim>(
            read_surface<dim>(parameters.shape_file,
                              section + "/Shape file",
                              parameters.shape_file_unit));
    if (!parameters.velocity.empty())
      velocity = {parameters.velocity, section + "/Velocity", {"t"}};
    if (!parameters.rotation.empty())
      rotation = {parameters.rotation, section + "/Rotation", {"t"}};
  }



  template <int dim>
  RigidPosition<dim>
  RigidBody<dim>::initial_position(const double t) const
  {
    RigidPosition<dim> position;
    position.reference = reference;
    return next_position(position, t, 0.);
  }



  template <int dim>
  RigidPosition<dim>
  RigidBody<dim>::next_position(const RigidPosition<dim> &position,
                                const double              t,
                                const double              dt) const
  {
    RigidPosition<dim> next = position;
    const QGauss<1>    quadrature(3);
    for (unsigned int q = 0; q < quadrature.size(); ++q)
      next.displacement +=
        dt * quadrature.weight(q) * velocity(t + dt * quadrature.point(q)[0]);
    next.velocity = velocity(t + dt);
    if (!rotation.is_zero())
      {
        next.rotation = rotation_matrix<dim>(rotation(t + dt));
        next.spin = (rotation(t + dt + moment) - rotation(t + dt - moment)) /
                    (2. * moment);
      }
    return next;
  }



  template <int dim>
  void
  RigidBody<dim>::find_gaps(std::vector<ContactPoint<dim>> &points,
                            const double                    reach,
                            const RigidPosition<dim>       &now,
                            const RigidPosition<dim>       &before) const
  {
    for (ContactPoint<dim> &point : points)
      {
        point.is_facing = false;
        // Shape and distances turn with the body.
        const auto closest =
          surface->closest(now.material_point(point.x), reach);
        if (!closest)
          continue;
        const Tensor<1, dim> normal = now.rotation * closest->normal;
        if (normal * point.normal > facing)
          continue;
        point.is_facing     = true;
        point.gap           = closest->distance;
        point.target_normal = normal;
        point.target_motion =
          now.position(closest->point) - before.position(closest->point);
      }
  }



  template class RigidBody<2>;
  template class RigidBody<3>;
} // namespace greville

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

    // Half the time (s) over which the spin is a difference quotient.
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
  RigidBody<dim>::position_at_start(const double t) const
  {
    RigidPosition<dim> position;
    position.reference = reference;
    AssertThrow(rotation.is_zero() || rotation(t).norm() == 0.,
                ExcMessage(
                  "The parameter 'Rigid body " + body_name +
                  "/Rotation' is not zero at the start, t = " + text_of(t) +
                  " s, where 'Shape' says how the body "
                  "is turned."));
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
        // dR / dt R^T is the cross product with the spin.
        const Tensor<2, dim> rate =
          (rotation_matrix<dim>(rotation(t + dt + moment)) -
           rotation_matrix<dim>(rotation(t + dt - moment))) *
          transpose(next.rotation) / (2. * moment);
        if constexpr (dim == 2)
          next.spin[0] = 0.5 * (rate[1][0] - rate[0][1]);
        else
          for (unsigned int d = 0; d < 3; ++d)
            next.spin[d] = 0.5 * (rate[(d + 2) % 3][(d + 1) % 3] -
                                  rate[(d + 1) % 3][(d + 2) % 3]);
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
          surface->closest(initial_position(now, point.x), reach);
        if (!closest)
          continue;
        const Tensor<1, dim> normal = now.rotation * closest->normal;
        if (normal * point.normal > facing)
          continue;
        point.is_facing     = true;
        point.gap           = closest->distance;
        point.target_normal = normal;
        point.target_motion = current_position(now, closest->point) -
                              current_position(before, closest->point);
      }
  }



  template class RigidBody<2>;
  template class RigidBody<3>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/rigid_trial.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  RigidTrial<dim>::RigidTrial(const RigidBody<dim>     &body,
                              const RigidPosition<dim> &start,
                              const Tensor<1, dim>     &gravity,
                              const ImplicitScheme     &scheme,
                              const double              dt)
    : body(body)
    , start(start)
    , scheme(scheme)
    , dt(dt)
  {
    const auto J = body.current_inertia(start);
    arm          = std::sqrt(trace(J) / (n_rotations * body.total_mass()));
    for (unsigned int d = 0; d < dim; ++d)
      {
        old_velocity[d] = start.velocity[d];
        weight[d]       = body.total_mass() * gravity[d];
      }
    for (unsigned int k = 0; k < n_rotations; ++k)
      old_velocity[dim + k] = arm * start.spin[k];
    if (!scheme.needs_acceleration())
      return;
    Vector torque;
    if constexpr (dim == 3)
      torque =
        load(Tensor<1, dim>(), cross_product_3d(start.spin, J * start.spin));
    old_acceleration = acceleration_by(weight - torque);
  }



  template <int dim>
  typename RigidTrial<dim>::Vector
  RigidTrial<dim>::acceleration_by(const Vector &load) const
  {
    Vector              result = load / body.total_mass();
    RotationVector<dim> moment;
    for (unsigned int k = 0; k < n_rotations; ++k)
      moment[k] = arm * load[dim + k];
    moment = invert(body.current_inertia(start)) * moment;
    for (unsigned int k = 0; k < n_rotations; ++k)
      result[dim + k] = arm * moment[k];
    return result;
  }



  template <int dim>
  typename RigidTrial<dim>::Matrix
  RigidTrial<dim>::inertia(const RigidPosition<dim> &position) const
  {
    Matrix result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d][d] = body.total_mass();
    const auto J = body.current_inertia(position);
    for (unsigned int k = 0; k < n_rotations; ++k)
      for (unsigned int l = 0; l < n_rotations; ++l)
        result[dim + k][dim + l] = J[k][l] / (arm * arm);
    return result;
  }



  template <int dim>
  RotationVector<dim>
  RigidTrial<dim>::rotation_of(const Vector &q) const
  {
    RotationVector<dim> result;
    for (unsigned int k = 0; k < n_rotations; ++k)
      result[k] = q[dim + k] / arm;
    return result;
  }



  template <int dim>
  typename RigidTrial<dim>::Vector
  RigidTrial<dim>::load(const Tensor<1, dim>      &force,
                        const RotationVector<dim> &moment) const
  {
    Vector result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = force[d];
    for (unsigned int k = 0; k < n_rotations; ++k)
      result[dim + k] = moment[k] / arm;
    return result;
  }



  template <int dim>
  typename RigidTrial<dim>::Vector
  RigidTrial<dim>::load_at(const Tensor<1, dim> &distance,
                           const Tensor<1, dim> &force) const
  {
    RotationVector<dim> moment;
    if constexpr (dim == 2)
      moment[0] = distance[0] * force[1] - distance[1] * force[0];
    else
      moment = cross_product_3d(distance, force);
    return load(force, moment);
  }



  template <int dim>
  Tensor<1, dim>
  RigidTrial<dim>::motion_at(const Tensor<1, dim> &distance,
                             const Vector         &q) const
  {
    Tensor<1, dim> result = cross<dim>(rotation_of(q), distance);
    for (unsigned int d = 0; d < dim; ++d)
      result[d] += q[d];
    return result;
  }



  template <int dim>
  typename RigidTrial<dim>::Vector
  RigidTrial<dim>::guess() const
  {
    return dt * old_velocity;
  }



  template <int dim>
  typename RigidTrial<dim>::Vector
  RigidTrial<dim>::acceleration(const Vector &q) const
  {
    return scheme.alpha_u / (dt * dt) * q - scheme.alpha_v / dt * old_velocity -
           scheme.alpha_a * old_acceleration;
  }



  template <int dim>
  RigidPosition<dim>
  RigidTrial<dim>::position(const Vector &q,
                            const double  share,
                            const Vector *load) const
  {
    RigidPosition<dim> result = start;
    Vector             velocity =
      old_velocity + dt * ((1. - scheme.gamma) * old_acceleration +
                           scheme.gamma * acceleration(q));
    // Add the part of the contact impulse that a' does not contain.
    if (load && scheme.needs_acceleration())
      velocity += dt * (1. - 0.5 * scheme.gamma * scheme.alpha_u) *
                  acceleration_by(*load);
    for (unsigned int d = 0; d < dim; ++d)
      {
        result.displacement[d] += share * q[d];
        result.velocity[d] = velocity[d];
      }
    result.rotation =
      rotation_matrix<dim>(share * rotation_of(q)) * start.rotation;
    result.spin = rotation_of(velocity);
    return result;
  }



  template <int dim>
  typename RigidTrial<dim>::Vector
  RigidTrial<dim>::residual(const Vector &q, const Vector &new_load) const
  {
    const Matrix M         = inertia(position(q, 0.5));
    Vector       of_motion = M * ((1. - scheme.alpha_m) * acceleration(q) +
                            scheme.alpha_m * old_acceleration);
    if constexpr (dim == 3)
      {
        // M contains the inertia divided by arm^2, and q is arm times the
        // rotation.
        const RotationVector<dim> spin = rotation_of(q) / dt;
        const RotationVector<dim> momentum =
          arm * rotation_of(arm / dt * (M * q));
        of_motion += load(Tensor<1, dim>(), cross_product_3d(spin, momentum));
      }
    return (of_motion - scheme.alpha_f * weight) / (1. - scheme.alpha_f) -
           scheme.contact_weight() * new_load - weight;
  }



  template <int dim>
  typename RigidTrial<dim>::Matrix
  RigidTrial<dim>::stiffness() const
  {
    return (1. - scheme.alpha_m) * scheme.alpha_u /
           ((1. - scheme.alpha_f) * dt * dt) * inertia(start);
  }



  template <int dim>
  double
  RigidTrial<dim>::scale(const Vector &new_load) const
  {
    return std::max(
      {new_load.norm(),
       weight.norm(),
       scheme.alpha_v / dt * body.total_mass() * old_velocity.norm()});
  }



  GREVILLE_INSTANTIATE_CLASS(RigidTrial);
} // namespace greville

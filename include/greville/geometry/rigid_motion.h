// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>

#include <cmath>

namespace greville
{
  /// A rotation or spin vector, along the axis; in 2D its component along z.
  template <int dim>
  using RotationVector = dealii::Tensor<1, dim == 2 ? 1 : 3>;



  /**
   * The position and the velocity of a rigid body: the material initially at X
   * is at
   *   x = X_0 + u + R (X - X_0),
   * and has the velocity v + w x (x - X_0 - u), with the reference point X_0,
   * the displacement u (m), rotation R, velocity v (m/s) and spin w (rad/s).
   */
  template <int dim>
  struct RigidPosition
  {
    dealii::Point<dim>     reference;
    dealii::Tensor<1, dim> displacement;
    dealii::Tensor<2, dim> rotation = dealii::unit_symmetric_tensor<dim>();
    dealii::Tensor<1, dim> velocity;
    RotationVector<dim>    spin;
  };



  /// Return the product of a rotation or a spin with a distance, w x r.
  template <int dim>
  dealii::Tensor<1, dim>
  cross(const RotationVector<dim> &w, const dealii::Tensor<1, dim> &r)
  {
    if constexpr (dim == 2)
      return dealii::Tensor<1, 2>({-w[0] * r[1], w[0] * r[0]});
    else
      return cross_product_3d(w, r);
  }



  /// Return the rotation for a vector along the axis, whose length is the angle
  /// (rad); in 3D by Rodrigues' formula.
  template <int dim>
  dealii::Tensor<2, dim>
  rotation_matrix(const RotationVector<dim> &vector)
  {
    const double angle = vector.norm();
    // sin(a) / a and (1 - cos(a)) / a^2.
    const double half   = 0.5 * angle;
    const double sine   = angle > 0. ? std::sin(angle) / angle : 1.;
    const double part   = angle > 0. ? std::sin(half) / half : 1.;
    const double cosine = 0.5 * part * part;

    dealii::Tensor<2, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        dealii::Tensor<1, dim> axis;
        axis[d]          = 1.;
        const auto once  = cross<dim>(vector, axis);
        const auto twice = cross<dim>(vector, once);
        for (unsigned int e = 0; e < dim; ++e)
          result[e][d] = axis[e] + sine * once[e] + cosine * twice[e];
      }
    return result;
  }



  /// Return the current position of the material initially at @p X.
  template <int dim>
  dealii::Point<dim>
  current_position(const RigidPosition<dim> &body, const dealii::Point<dim> &X)
  {
    return body.reference + body.displacement +
           body.rotation * (X - body.reference);
  }



  /// Return the initial position of the material at @p x: the inverse of
  /// current_position().
  template <int dim>
  dealii::Point<dim>
  initial_position(const RigidPosition<dim> &body, const dealii::Point<dim> &x)
  {
    return body.reference +
           transpose(body.rotation) * (x - body.reference - body.displacement);
  }



  /// Return the velocity of the body at the current position @p x.
  template <int dim>
  dealii::Tensor<1, dim>
  velocity_at(const RigidPosition<dim> &body, const dealii::Point<dim> &x)
  {
    return body.velocity +
           cross<dim>(body.spin, x - body.reference - body.displacement);
  }



  /// Rotate the body for a time @p dt, exactly for a constant spin.
  template <int dim>
  void
  rotate(RigidPosition<dim> &body, const double dt)
  {
    const dealii::Tensor<2, dim> turned =
      rotation_matrix<dim>(dt * body.spin) * body.rotation;
    // Take a step of Newton's method towards the nearest rotation, so that
    // round-off does not accumulate.
    const dealii::Tensor<2, dim> unit = dealii::unit_symmetric_tensor<dim>();
    body.rotation = 0.5 * turned * (3. * unit - transpose(turned) * turned);
  }
} // namespace greville

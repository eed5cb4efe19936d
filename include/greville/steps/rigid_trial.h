// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/rigid_body.h>
#include <greville/steps/implicit_scheme.h>

namespace greville
{
  /**
   * A free rigid body in a trial of an implicit step. Its unknowns q are the
   * displacement u of its reference point in the step, and its rotation vector
   * @f$\varphi@f$ in the step times its radius of gyration. All unknowns are
   * therefore in m, and residuals in N (2D: N / m). With the formulas of the
   * scheme for accelerations a' and @f$\alpha'@f$ (ImplicitScheme), the
   * equations are
   * @f[ m a' = f + m g, \qquad J \alpha' + w \times J w = M, @f]
   * with the inertia @f$J = R I R^T@f$, the mean spin @f$w = \varphi / \Delta
   * t@f$, and force f and moment M (about the reference point) of contacts at
   * the time of ImplicitScheme::load_time, weighted by
   * ImplicitScheme::contact_weight().
   */
  template <int dim>
  class RigidTrial
  {
  public:
    static constexpr unsigned int n_rotations = dim == 2 ? 1 : 3;
    static constexpr unsigned int n_unknowns  = dim + n_rotations;

    using Vector = dealii::Tensor<1, n_unknowns>;
    using Matrix = dealii::Tensor<2, n_unknowns>;

    /// The @p body is given at the start of a step of length @p dt, s;
    /// @p gravity belongs to the time of loads, m / s^2.
    RigidTrial(const RigidBody<dim>         &body,
               const RigidPosition<dim>     &start,
               const dealii::Tensor<1, dim> &gravity,
               const ImplicitScheme         &scheme,
               const double                  dt);

    /// Return the unknowns for motion with constant velocity.
    Vector
    guess() const;

    /// Return the position of the body after a share of the step, with the
    /// velocity at the end. This includes the effect of the @p load unless
    /// null.
    RigidPosition<dim>
    position(const Vector &q,
             const double  share,
             const Vector *load = nullptr) const;

    /// Return the load, in terms of q, of a force and a moment about the
    /// reference point, N and N m (2D: N / m and N).
    Vector
    load(const dealii::Tensor<1, dim> &force,
         const RotationVector<dim>    &moment) const;

    /// Return the load of a force at a @p distance from the reference point.
    Vector
    load_at(const dealii::Tensor<1, dim> &distance,
            const dealii::Tensor<1, dim> &force) const;

    /// Return the displacement by q of a point at a @p distance.
    dealii::Tensor<1, dim>
    motion_at(const dealii::Tensor<1, dim> &distance, const Vector &q) const;

    /// Return the residual with the load of the trial.
    Vector
    residual(const Vector &q, const Vector &load) const;

    /// Return the derivative of the inertia terms by q.
    Matrix
    stiffness() const;

    /// Return the largest of the forces in the residual.
    double
    scale(const Vector &load) const;

  private:
    /// Return the mass and the inertia in a position.
    Matrix
    inertia(const RigidPosition<dim> &position) const;

    /// Return the rotation vector, or the spin.
    RotationVector<dim>
    rotation_of(const Vector &q) const;

    /// Return the acceleration by a load, without the gyroscopic term.
    Vector
    acceleration_by(const Vector &load) const;

    /// Return a' and alpha'.
    Vector
    acceleration(const Vector &q) const;

    const RigidBody<dim>    &body;
    const RigidPosition<dim> start;
    const ImplicitScheme     scheme;
    const double             dt;
    double                   arm = 1.; // the radius of gyration, m
    Vector                   old_velocity, old_acceleration, weight;
  };
} // namespace greville

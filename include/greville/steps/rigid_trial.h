// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_rigid_trial_h
#define greville_steps_rigid_trial_h

#include <greville/contact/rigid_body.h>
#include <greville/steps/implicit_scheme.h>

namespace greville
{
  /**
   * A free rigid body in an implicit step that is tried. Its unknowns q are the
   * displacement u of its reference point in the step, and the vector of its
   * rotation @f$\varphi@f$ in the step times its radius of gyration, so that
   * all of them are in m, and residuals in N (in 2D N / m). With the formulas
   * of the scheme
   * for accelerations a' and @f$\alpha'@f$ from these (ImplicitScheme), the
   * equations are
   * @f[ m a' = f + m g, \qquad J \alpha' + w \times J w = M, @f]
   * with the inertia @f$J = R I R^T@f$ and the mean spin
   * @f$w = \varphi / \Delta t@f$, and force f and moment M (about the reference
   * point) of contacts at the time of ImplicitScheme::load_time, which have
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

    /**
     * The @p body at the start of a step of length @p dt, s; @p gravity belongs
     * to the time of loads, m / s^2.
     */
    RigidTrial(const RigidBody<dim>         &body,
               const RigidPosition<dim>     &start,
               const dealii::Tensor<1, dim> &gravity,
               const ImplicitScheme         &scheme,
               const double                  dt);

    /// The unknowns if it goes on with its velocity.
    Vector
    guess() const;

    /// Where it is after a share of the step, with the velocity at the end, to
    /// which a @p load belongs if it is given.
    RigidPosition<dim>
    position(const Vector &q,
             const double  share,
             const Vector *load = nullptr) const;

    /// A force and a moment about the reference point, N and N m (2D: N / m
    /// and N), as q sees them.
    Vector
    load(const dealii::Tensor<1, dim> &force,
         const RotationVector<dim>    &moment) const;

    /// That of a force at a @p distance from the reference point.
    Vector
    load_at(const dealii::Tensor<1, dim> &distance,
            const dealii::Tensor<1, dim> &force) const;

    /// How far q moves a point there.
    dealii::Tensor<1, dim>
    motion_at(const dealii::Tensor<1, dim> &distance, const Vector &q) const;

    /// The residual with the load of the trial.
    Vector
    residual(const Vector &q, const Vector &load) const;

    /// The derivative of the inertia by q.
    Matrix
    stiffness() const;

    /// The largest of the forces that the residual consists of.
    double
    scale(const Vector &load) const;

  private:
    /// The mass and the inertia of a position.
    Matrix
    inertia(const RigidPosition<dim> &position) const;

    /// The vector of rotation, or the spin.
    RotationVector<dim>
    rotation_of(const Vector &q) const;

    /// By a load, without that of the spin.
    Vector
    acceleration_by(const Vector &load) const;

    /// a' and alpha'.
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

#endif

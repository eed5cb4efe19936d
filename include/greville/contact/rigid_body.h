// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_contact_rigid_body_h
#define greville_contact_rigid_body_h

#include <greville/base/expression.h>
#include <greville/contact/contact_point.h>
#include <greville/geometry/closest_surface.h>
#include <greville/geometry/rigid_motion.h>
#include <greville/parameters/section_parameters.h>

#include <memory>
#include <vector>

namespace greville
{
  /**
   * What moves a rigid body in a step from t to t + dt, s.
   */
  template <int dim>
  struct RigidStep
  {
    double t = 0., dt = 0.;
    /// The time between the velocities of this step and the one before, s.
    double velocity_dt = 0.;
    /// Of contacts, at t: N (2D: N / m), and N m (2D: N) about its reference
    /// point; and m / s^2.
    dealii::Tensor<1, dim> force;
    RotationVector<dim>    moment;
    dealii::Tensor<1, dim> gravity;
  };



  /**
   * A body that does not deform: its surface, and its motion, which formulas of
   * t give, or forces:
   * @f[ m \dot v = f + m g, \qquad (R I R^T w)^\cdot = M @f]
   * with mass m, velocity v of the center of mass, rotation R, inertia I in the
   * initial configuration and spin w; by central differences, with v and w at
   * half steps. Where it is belongs to the State.
   */
  template <int dim>
  class RigidBody
  {
  public:
    /**
     * Throws dealii::ExcMessage where the parameters are wrong.
     */
    RigidBody(const std::string &name, const RigidBodyParameters &parameters);

    /**
     * Where it is at the start, at time @p t, s.
     */
    RigidPosition<dim>
    position_at_start(const double t) const;

    /**
     * Move it from where it is @p now, and has come to from @p before, to the
     * end of the step.
     */
    void
    move(RigidPosition<dim>   &now,
         RigidPosition<dim>   &before,
         const RigidStep<dim> &step) const;

    /**
     * Set ContactPoint::is_facing, gap, target_normal and target_motion of the
     * points that are closer than @p reach, m, to the body in its position
     * @p now, where it has come from @p before in the step.
     */
    void
    find_gaps(std::vector<ContactPoint<dim>> &points,
              const double                    reach,
              const RigidPosition<dim>       &now,
              const RigidPosition<dim>       &before) const;

    /**
     * Return whether a point for which find_gaps() was called has passed from
     * one side of the body towards the opposite one in the step: it has come in
     * on one side, or was closer to that, and leaves by the other one. Contact
     * then presses it out of the wrong side, or ends.
     */
    bool
    lets_through(const ContactPoint<dim>  &point,
                 const double              reach,
                 const RigidPosition<dim> &now,
                 const RigidPosition<dim> &before) const;

    /**
     * Return whether a point @p x (m) is inside of the body in a position.
     */
    bool
    contains(const dealii::Point<dim> &x, const RigidPosition<dim> &now) const
    {
      return surface->contains(initial_position(now, x));
    }

    /**
     * Return whether some of the body may be closer than @p margin (m) to a @p
     * region: false where none is, but for parts of a formula that are much
     * smaller than the region.
     */
    bool
    may_be_near(const dealii::BoundingBox<dim> &region,
                const double                    margin,
                const RigidPosition<dim>       &now) const;

    /**
     * Return the largest distance (m) between the places that a point of the
     * body has in two positions; of its part in the @p region if its end is not
     * known.
     */
    double
    way(const RigidPosition<dim>       &before,
        const RigidPosition<dim>       &now,
        const dealii::BoundingBox<dim> &region) const;

    /**
     * A mesh of its surface in the initial position, see
     * ClosestSurface::mesh(), for a box that is around the body @p now. It
     * holds until the next call.
     */
    const ClosedSurface<dim> &
    mesh(const RigidPosition<dim>       &now,
         const dealii::BoundingBox<dim> &region) const;

    const std::string &
    name() const
    {
      return body_name;
    }

    bool
    is_free() const
    {
      return free;
    }

    /// Of free bodies, kg (2D: kg / m).
    double
    total_mass() const
    {
      return mass;
    }

    /// Of free bodies, where they are turned to: R I R^T, kg m^2 (2D: kg m).
    dealii::Tensor<2, dim == 2 ? 1 : 3>
    current_inertia(const RigidPosition<dim> &position) const;

  private:
    static constexpr int n_rotations = dim == 2 ? 1 : 3;

    /// Move it as the formulas say: velocities are integrated by three points
    /// of Gauss.
    void
    follow(RigidPosition<dim> &position, const double t, const double dt) const;

    std::string                          body_name;
    bool                                 free;
    dealii::Point<dim>                   reference;
    std::unique_ptr<ClosestSurface<dim>> surface;
    VectorExpression<dim>                velocity;
    VectorExpression<n_rotations>        rotation; // its vector
    double                               mass = 0.;
    dealii::Tensor<2, n_rotations>       inertia;

    /// ClosestSurface::box(), which takes long to find.
    dealii::BoundingBox<dim> extent;

    /// The last mesh, and the box for it, in the initial position: it matters
    /// where the end of the body is not known.
    mutable ClosedSurface<dim>       last_mesh;
    mutable dealii::BoundingBox<dim> last_region;
    mutable bool                     has_end = false;
  };
} // namespace greville

#endif

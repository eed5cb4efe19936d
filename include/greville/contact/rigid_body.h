// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/contact_point.h>
#include <greville/geometry/closest_surface.h>
#include <greville/geometry/rigid_motion.h>
#include <greville/parameters/section_parameters.h>

#include <memory>
#include <vector>

namespace greville
{
  /// The data of a step of a rigid body from t to t + dt, s.
  template <int dim>
  struct RigidStep
  {
    double t = 0., dt = 0.;
    /// The time between the velocities of this step and of the previous one, s.
    double velocity_dt = 0.;
    /// Contact force at t, N (2D: N / m), moment about the reference point, N m
    /// (2D: N), and gravity, m / s^2.
    dealii::Tensor<1, dim> force;
    RotationVector<dim>    moment;
    dealii::Tensor<1, dim> gravity;
  };



  /**
   * A rigid body: its surface, and its motion, which is given by formulas of t
   * or follows from forces:
   * @f[ m \dot v = f + m g, \qquad (R I R^T w)^\cdot = M @f]
   * with mass m, velocity v of the center of mass, rotation R, inertia I in the
   * initial configuration and spin w; by central differences, with v and w at
   * half steps. Its position is part of the State.
   */
  template <int dim>
  class RigidBody
  {
  public:
    /// Throws dealii::ExcMessage for invalid parameters.
    RigidBody(const std::string &name, const RigidBodyParameters &parameters);

    /// Return the initial position, at time @p t, s.
    RigidPosition<dim>
    position_at_start(const double t) const;

    /// Move the body from its position @p now to the end of the step. The
    /// previous step began at the position @p before.
    void
    move(RigidPosition<dim>   &now,
         RigidPosition<dim>   &before,
         const RigidStep<dim> &step) const;

    /// Set ContactPoint::is_facing, gap, target_normal and target_motion of the
    /// points that are closer than @p reach times ContactPoint::cell_size to
    /// the body in its position @p now, which was @p before at the start of the
    /// step.
    void
    find_gaps(std::vector<ContactPoint<dim>> &points,
              const double                    reach,
              const RigidPosition<dim>       &now,
              const RigidPosition<dim>       &before) const;

    /// Return whether a point for which find_gaps() was called has passed
    /// through the body in the step: it entered on one side, or was closer to
    /// that side, and leaves on the opposite one. Contact would then push it
    /// out on the wrong side, or end.
    bool
    is_crossed_by(const ContactPoint<dim>  &point,
                  const double              reach,
                  const RigidPosition<dim> &now,
                  const RigidPosition<dim> &before) const;

    /// Return whether a point @p x (m) is inside the body in a position.
    bool
    contains(const dealii::Point<dim> &x, const RigidPosition<dim> &now) const
    {
      return surface->contains(initial_position(now, x));
    }

    /// Return whether some part of the body may be closer than @p margin (m) to
    /// a @p region; parts of a formula that are much smaller than the region
    /// may be missed.
    bool
    may_be_near(const dealii::BoundingBox<dim> &region,
                const double                    margin,
                const RigidPosition<dim>       &now) const;

    /// Return the largest displacement (m) of a point of the body between two
    /// positions. If the extent of the body is not known, only its part in the
    /// @p region counts.
    double
    way(const RigidPosition<dim>       &before,
        const RigidPosition<dim>       &now,
        const dealii::BoundingBox<dim> &region) const;

    /// Return a mesh of its surface in the initial position, see
    /// ClosestSurface::mesh(), for a box around the body @p now. The mesh is
    /// valid until the next call.
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

    /// Return the mass of a free body, kg (2D: kg / m).
    double
    total_mass() const
    {
      return mass;
    }

    /// Return the inertia of a free body in its current rotation: R I R^T, kg
    /// m^2 (2D: kg m).
    dealii::Tensor<2, dim == 2 ? 1 : 3>
    current_inertia(const RigidPosition<dim> &position) const;

  private:
    static constexpr int n_rotations = dim == 2 ? 1 : 3;

    /// Move the body by its formulas: velocities are integrated with three
    /// Gauss points.
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

    /// The result of ClosestSurface::box(), which is expensive.
    dealii::BoundingBox<dim> extent;

    /// The last mesh and its box, in the initial position. The box matters only
    /// if the extent of the body is not known.
    mutable ClosedSurface<dim>       last_mesh;
    mutable dealii::BoundingBox<dim> last_region;
    mutable bool                     has_end = false;
  };
} // namespace greville

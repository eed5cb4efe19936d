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
   * A body that does not deform: its surface, and its motion as formulas of t
   * give it. Where it is belongs to the State.
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
     * Where it is at t + dt (s), if it is at @p position at time t: the
     * velocity is integrated by three points of Gauss.
     */
    RigidPosition<dim>
    next_position(const RigidPosition<dim> &position,
                  const double              t,
                  const double              dt) const;

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

    const std::string &
    name() const
    {
      return body_name;
    }

  private:
    std::string                          body_name;
    dealii::Point<dim>                   reference;
    std::unique_ptr<ClosestSurface<dim>> surface;
    VectorExpression<dim>                velocity;
    VectorExpression<dim == 2 ? 1 : dim> rotation; // its vector
  };
} // namespace greville

#endif

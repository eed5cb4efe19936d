// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/late_row.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  LateState<dim>::take(const State<dim>     &now,
                       const GridField<dim> &field,
                       const double          weight,
                       const bool            is_kicked)
  {
    FieldState<dim> &kept = state.field;
    if (is_kicked)
      for (unsigned int d = 0; d < dim; ++d)
        {
          // (v' - v) / dt', without the momentum that walls take from points.
          VectorType &a = kept.acceleration[d], &v = kept.velocity[d];
          a = field.new_velocity[d];
          a -= v;
          v.add(weight, a);
          a *= weight / (now.time - now.velocity_time);
        }
    else
      {
        state               = now;
        state.velocity_time = now.time;
        kept.velocity       = field.velocity;
        // Undo the motion of rigid bodies in this step.
        for (RigidBodyState<dim> &body : state.rigid_bodies)
          body.now = body.before;
      }
    // The points of both states are in the same order.
    for (unsigned int b = 0; b < now.bodies.size(); ++b)
      {
        std::vector<double> velocities;
        now.bodies[b].points.for_each(
          [&](const unsigned int, ConstPointRef<dim> p) {
            for (unsigned int d = 0; d < dim; ++d)
              velocities.push_back(weight * p.velocity(d));
          });
        const double *v = velocities.data();
        state.bodies[b].points.for_each(
          [&](const unsigned int, PointRef<dim> p) {
            for (unsigned int d = 0; d < dim; ++d)
              p.velocity(d) = (is_kicked ? p.velocity(d) : 0.) + *v++;
          });
      }
  }



  template struct LateState<2>;
  template struct LateState<3>;
} // namespace greville

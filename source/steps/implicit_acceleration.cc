// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/step_errors.h>
#include <greville/steps/implicit_steps.h>
#include <greville/steps/stage_bodies.h>

#include <algorithm>

// The accelerations at the start and at the end of a step of ImplicitSteps.
namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  ImplicitSteps<dim>::solve_mass(VectorField<dim> &x, const VectorField<dim> &b)
  {
    const PartTimer   timer(log, "solve");
    const SolveResult result = system.solve_mass(x, b);
    if (!result.converged)
      throw StepFailed("the solver of the mass matrix " + result.reason);
  }



  namespace
  {
    /// Swap the kept accelerations of points with their velocities, so that
    /// transfers of velocities act on accelerations.
    template <int dim>
    void
    exchange_with_velocity(std::vector<Body<dim>> &bodies)
    {
      for (Body<dim> &body : bodies)
        {
          const unsigned int kept = body.points.layout().first("acceleration");
          body.points.for_each([&](PointRef<dim> p) {
            for (unsigned int d = 0; d < dim; ++d)
              std::swap(p.velocity(d), p[kept + d]);
          });
        }
    }
  } // namespace



  template <int dim>
  void
  ImplicitSteps<dim>::find_acceleration(State<dim> &state)
  {
    if (scheme.keeps_acceleration && state.field.history.n > 0)
      {
        // The kept acceleration is due to all forces.
        if (!keeps_in_points(state.bodies))
          {
            if (find_contact_acceleration())
              for (unsigned int d = 0; d < dim; ++d)
                acceleration[d] -= contact_acceleration[d];
            return;
          }
        std::vector<const MaterialPoints<dim> *> points;
        for (const Body<dim> &body : state.bodies)
          points.push_back(&body.points);
        VectorType mass = field().lumped_mass;
        exchange_with_velocity(state.bodies);
        discretization.transfer().points_to_grid(points, &mass, &work, nullptr);
        exchange_with_velocity(state.bodies);
        for (unsigned int d = 0; d < dim; ++d)
          work[d] -= contact_load[d];
      }
    else
      for (unsigned int d = 0; d < dim; ++d)
        {
          work[d] = old_force[d];
          work[d] += old_loads[d];
        }
    solve_mass(acceleration, work);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::find_new_acceleration(VectorField<dim> &result,
                                            const double      dt) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        result[d].equ(scheme.alpha_u / (dt * dt), displacement[d]);
        result[d].add(-scheme.alpha_v / dt,
                      velocity[d],
                      -scheme.alpha_a,
                      acceleration[d]);
        if (contact_force)
          result[d].add(-0.5 * scheme.alpha_u, contact_acceleration[d]);
      }
  }



  template <int dim>
  bool
  ImplicitSteps<dim>::find_contact_acceleration()
  {
    double largest = 0.;
    for (const VectorType &component : contact_load)
      largest = std::max(largest, component.linfty_norm());
    if (largest > 0.)
      solve_mass(contact_acceleration, contact_load);
    return largest > 0.;
  }



  template <int dim>
  void
  ImplicitSteps<dim>::keep_acceleration(State<dim> &state, const double dt)
  {
    if (!scheme.keeps_acceleration)
      return;
    VectorField<dim> &kept = state.field.history.accelerations[0];
    kept                   = acceleration;
    find_new_acceleration(kept, dt);
    for (unsigned int d = 0; d < dim && contact_force; ++d)
      kept[d] += contact_acceleration[d];
    state.field.history.n = 1;
    if (!keeps_in_points(state.bodies))
      return;
    PointUpdate<dim> update;
    update.acceleration = update.velocity = &kept;
    update.flip                           = 0.;
    exchange_with_velocity(state.bodies);
    update_points(state.bodies, discretization.transfer(), update, state.time);
    exchange_with_velocity(state.bodies);
  }



  GREVILLE_INSTANTIATE_CLASS(ImplicitSteps);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/step_errors.h>
#include <greville/steps/central_differences.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Accelerations that change velocities by this fraction of the norm of all
    // velocities in a step are solved for to the tolerance times that change.
    constexpr double negligible_kick = 1e-6;

    // The part of a step that stands for a moment in the difference quotient
    // of a displacement.
    constexpr double moment = 1e-3;

  } // namespace



  template <int dim>
  CentralDifferences<dim>::CentralDifferences(const StressUpdate          order,
                                              const IntegratorParts<dim> &parts)
    : order(order)
    , parameters(parts.parameters)
    , discretization(parts.discretization)
    , mass(discretization.mass())
    , consistent(discretization.consistent_mass())
    , walls(discretization.walls())
    , loads(parts.loads)
    , log(parts.log)
    , guard(parts.guard)
    , late_row(parts.late_row)
    , apic(parameters.scheme.transfer == "APIC")
    , half_steps(parameters.time.velocities == "half steps")
    , damping(parameters.loads, discretization)
    , step_size(parameters.time,
                discretization,
                !rigid_bodies(parts.initial.bodies).empty(),
                log)
  {
    if (consistent && walls.have_friction())
      contact = std::make_unique<FrictionContact<dim>>(walls, *consistent);
    if (consistent)
      filter.reinit(mass.space());
    if (!rigid_bodies(parts.initial.bodies).empty())
      {
        obstacles = std::make_unique<Obstacles<dim>>();
        obstacles->reinit(mass.space());
      }
    for (auto *field : {&trial.force,
                        &trial.velocity,
                        &trial.acceleration,
                        &trial.new_velocity,
                        &work_field,
                        &surface_velocity})
      discretization.initialize(*field);
  }



  template <int dim>
  double
  CentralDifferences<dim>::flip_share(const State<dim> &state,
                                      const double      velocity_step) const
  {
    return greville::flip_share(parameters.scheme,
                                discretization.cell_size(),
                                state.first_signal,
                                velocity_step);
  }



  template <int dim>
  double
  CentralDifferences<dim>::kept_share(const State<dim> &state) const
  {
    return apic ? 0. : flip_share(state, trial.velocity_step);
  }



  template <int dim>
  double
  CentralDifferences<dim>::propose_step(State<dim> &state)
  {
    StepScheme scheme;
    scheme.stress_update = order;
    scheme.apic          = apic;
    // Smaller shares have the shorter step, and dt is not known yet.
    scheme.flip =
      std::min(parameters.scheme.flip, flip_share(state, state.velocity_step));
    scheme.damping = damping.factor();
    return step_size.propose(state, scheme);
  }



  template <int dim>
  void
  CentralDifferences<dim>::solve(
    const std::vector<VectorField<dim> *>       &fields,
    const std::vector<const VectorField<dim> *> &sums,
    const std::vector<double>                   &shares)
  {
    const unsigned int n = discretization.solve(fields, sums, shares);
    trial.n_iterations   = std::max(trial.n_iterations, n);
    trial.n_all_iterations += n;
  }



  template <int dim>
  WallTime
  CentralDifferences<dim>::wall_time(const State<dim> &state) const
  {
    return {state.velocity_time + trial.velocity_step,
            trial.step > 0. ? state.time : state.time - moment * state.step,
            state.time + trial.step};
  }



  template <int dim>
  void
  CentralDifferences<dim>::touch_obstacles(const State<dim> &state,
                                           const bool        with_force)
  {
    if (!obstacles)
      return;
    obstacles->touch(mass,
                     discretization.lumped_mass(),
                     discretization.momentum(),
                     with_force ? &trial.force : nullptr,
                     loads.gravity(state.time));
    if (!with_force || order != StressUpdate::USF)
      obstacles->set_velocity(trial.velocity, false);
    obstacles->set_acceleration(trial.acceleration, trial.velocity);
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_gravity(const double t)
  {
    const VectorType    &lumped = discretization.lumped_mass();
    const Tensor<1, dim> g      = loads.gravity(t);
    for (unsigned int d = 0; d < dim; ++d)
      if (g[d] != 0.)
        for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
          trial.force[d].local_element(i) += g[d] * lumped.local_element(i);
  }



  template <int dim>
  void
  CentralDifferences<dim>::find_acceleration(State<dim> &state)
  {
    impose_velocities(state.bodies, state.time + 0.5 * trial.step);
    if (obstacles)
      obstacles->update(state.bodies,
                        discretization.transfer(),
                        state.velocity_time,
                        state.velocity_time + trial.velocity_step);
    // Both ends do work.
    fail_with(
      [&]() {
        loads.gravity(state.time);
        loads.gravity(state.time + trial.step);
      },
      false);
    {
      const PartTimer timer(log, "loads");
      const auto      set = [&]() {
        loads.set(state.bodies, state.time);
        loads.surfaces().set(state.surfaces, state.time);
      };
      if (loads.act_on_points() || !state.surfaces.empty())
        fail_with([&]() { run_on_all(set, discretization.communicator()); },
                  false);
    }

    // Velocity and acceleration come from one solve, unless the stress depends
    // on the velocity.
    const bool   stress_first = order == StressUpdate::USF;
    const double dt           = trial.velocity_step;
    const double share        = kept_share(state);
    trial.momentum_of_walls   = {};
    trial.momentum            = {};
    discretization.sum(state, stress_first ? nullptr : &trial.force);
    trial.momentum.add(discretization.momentum(), 1.);
    trial.velocity = state.velocity;
    std::swap(trial.acceleration, state.acceleration);
    const WallTime after  = wall_time(state);
    WallTime       before = after;
    before.t              = state.velocity_time;
    if (state.step > 0.)
      {
        before.begin = state.time - state.step;
        before.end   = state.time;
      }
    walls.hold_velocity(trial.velocity, before);
    walls.hold_acceleration(trial.acceleration,
                            before,
                            after,
                            trial.velocity_step);
    touch_obstacles(state, !stress_first);
    if (stress_first)
      {
        solve({&trial.velocity}, {&discretization.momentum()});
        add_momentum_of_walls(trial.velocity,
                              discretization.momentum(),
                              0,
                              1. - share);
        add_momentum_of_walls(walls.stop(trial.velocity,
                                         discretization.lumped_mass()),
                              1. - share);
        update(state, nullptr, nullptr, &trial.velocity, false);
        discretization.sum(state, &trial.force);
        touch_obstacles(state, true);
        add_gravity(state.time);
        solve({&trial.acceleration}, {&trial.force});
        add_momentum_of_walls(trial.acceleration, trial.force, 0, dt);
      }
    else
      {
        add_gravity(state.time);
        // Forces of round-off need no solve.
        solve({&trial.velocity, &trial.acceleration},
              {&discretization.momentum(), &trial.force},
              {1., dt > 0. ? negligible_kick / dt : 0.});
        add_momentum_of_walls(trial.velocity,
                              discretization.momentum(),
                              0,
                              1. - share);
        add_momentum_of_walls(trial.acceleration, trial.force, 1, dt);
      }
    trial.momentum.add(trial.force, dt);
    damping.damp(trial.acceleration, trial.force);
  }



  template <int dim>
  void
  CentralDifferences<dim>::filter_velocity()
  {
    if (!consistent || parameters.scheme.filter == 0. ||
        parameters.scheme.is_total_lagrangian())
      return;
    const PartTimer timer(log, "filter");
    filter.set_mass(discretization.lumped_mass());
    VectorField<dim> &correction = work_field;
    filter.apply(correction,
                 trial.new_velocity,
                 parameters.scheme.filter,
                 trial.step);
    consistent->extend(correction);
    // Without walls it keeps the momentum.
    const VectorType &lumped = discretization.lumped_mass();
    walls.add_held(trial.momentum_of_walls,
                   [&](const unsigned int c, const unsigned int i) {
                     return -lumped.local_element(i) *
                            correction[c].local_element(i);
                   });
    for (unsigned int d = 0; d < dim; ++d)
      {
        VectorType &z = correction[d];
        for (unsigned int i = 0; i < z.locally_owned_size(); ++i)
          if ((mass.held_components(i) >> d) & 1)
            z.local_element(i) = 0.;
        trial.new_velocity[d] += z;
        trial.acceleration[d].add(1. / trial.velocity_step, z);
      }
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_contact(State<dim> &state)
  {
    if (!contact)
      {
        if (walls.have_friction())
          work_field = trial.new_velocity;
        add_momentum_of_walls(walls.add_contact(trial.new_velocity,
                                                trial.acceleration,
                                                trial.velocity_step,
                                                discretization.lumped_mass()));
        if (walls.have_friction())
          add_work_of_friction(state);
        // Obstacles go first.
        if (obstacles)
          {
            obstacles->set_velocity(trial.new_velocity, true);
            obstacles->set_acceleration(trial.acceleration, trial.velocity);
          }
        return;
      }
    const PartTimer timer(log, "contact");
    fail_with([&]() {
      add_momentum_of_walls(contact->add(trial.new_velocity,
                                         trial.acceleration,
                                         trial.velocity_step,
                                         state.slid));
    });
    trial.n_iterations =
      std::max(trial.n_iterations, contact->most_iterations());
    trial.n_all_iterations += contact->n_iterations();
    const double before = contact->work(trial.velocity, trial.velocity),
                 after  = contact->work(trial.new_velocity, trial.new_velocity);
    state.energy.add_friction(0.5 * (before + after));
    if (row)
      row->energy.add_friction(row->part_of_work(before, after));
  }



  template <int dim>
  void
  CentralDifferences<dim>::take_held_residual(const State<dim> &state)
  {
    if (parameters.scheme.transfer != "FLIP" || !(trial.velocity_step > 0.))
      return;
    mass.held_residual(work_field, discretization.momentum(), trial.velocity);
    for (unsigned int d = 0; d < dim; ++d)
      trial.acceleration[d].add(-1. / trial.velocity_step, work_field[d]);
    const VectorType &lumped = discretization.lumped_mass();
    const double      share  = kept_share(state);
    walls.add_held(trial.momentum_of_walls,
                   [&](const unsigned int c, const unsigned int i) {
                     return -share * lumped.local_element(i) *
                            work_field[c].local_element(i);
                   });
  }



  template <int dim>
  void
  CentralDifferences<dim>::find_new_velocity(State<dim> &state)
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        trial.new_velocity[d] = trial.velocity[d];
        trial.new_velocity[d].add(trial.velocity_step, trial.acceleration[d]);
      }
    filter_velocity();
    add_contact(state);
    if (trial.step == 0.)
      state.acceleration = trial.acceleration;
    take_held_residual(state);
    for (unsigned int w = 0; w < 2 * dim && trial.velocity_step > 0.; ++w)
      state.reactions[w] = trial.momentum_of_walls[w] / trial.velocity_step;
    add_work(state);
    add_work_of_damping(state);
  }



  template <int dim>
  void
  CentralDifferences<dim>::finish(State<dim> &state)
  {
    // Nothing moves: what is left of the kick acts where the points are.
    if (!velocities_lag(state))
      return;
    const auto reactions = state.reactions;
    const auto contact_loads =
      contact ? contact->loads() : std::vector<Tensor<1, dim>>();
    row                    = nullptr; // of a step that has failed
    trial.step             = 0.;
    trial.velocity_step    = 0.5 * state.step;
    trial.deformation_step = state.step;
    trial.motion           = PointMotion();
    find_acceleration(state);
    find_new_velocity(state);
    update(state, &trial.acceleration, &trial.new_velocity, nullptr, false);
    add_work_of_point_loads(state, true);
    fail_on_all(trial.motion.problem, discretization.communicator());
    state.velocity  = trial.new_velocity;
    state.reactions = reactions;
    if (contact)
      contact->set_loads(contact_loads);
    state.velocity_time += trial.velocity_step;
    guard.set_swing(swing(state));
  }



  template <int dim>
  double
  CentralDifferences<dim>::swing(const State<dim> &state) const
  {
    // Steps that map velocities with lumped mass before they deform points damp
    // high modes, and keep another energy.
    if (!mass.is_exact() && order != StressUpdate::USL)
      return 0.;
    double square = 0.; // a^T M a
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < trial.force[d].locally_owned_size(); ++i)
        square += trial.acceleration[d].local_element(i) *
                  trial.force[d].local_element(i);
    return 0.125 * state.step * state.step * square;
  }



  template <int dim>
  void
  CentralDifferences<dim>::begin_row(const State<dim> &state)
  {
    row = late_row.is_wanted && half_steps ? &late_row : nullptr;
    if (!row)
      return;
    row->energy = state.energy;
    row->fraction =
      trial.velocity_step > 0.
        ? std::clamp((state.time - state.velocity_time) / trial.velocity_step,
                     0.,
                     1.)
        : 0.;
  }



  template <int dim>
  void
  CentralDifferences<dim>::end_row(const State<dim> &state)
  {
    if (!row)
      return;
    row->swing    = swing(state);
    row->is_known = true;
    row           = nullptr;
  }



  template <int dim>
  bool
  CentralDifferences<dim>::may_reject() const
  {
    return consistent && parameters.time.step.empty() &&
           order != StressUpdate::USF;
  }



  template <int dim>
  void
  CentralDifferences<dim>::try_step(State<dim> &state, const double dt)
  {
    trial.step             = dt;
    trial.velocity_step    = half_steps ? 0.5 * (state.step + dt) : dt;
    trial.deformation_step = half_steps ? state.step : dt;
    trial.motion           = PointMotion();
    if (state.n_rejections == 0)
      trial.n_iterations = trial.n_all_iterations = 0;
    if (!may_reject())
      return;
    find_acceleration(state);

    // One that has been rejected before is taken.
    const bool is_too_long =
      state.n_rejections == 0 &&
      step_size.shows_faster_mode(state, trial.acceleration, dt);
    // The guess of another trial.
    std::swap(state.acceleration, trial.acceleration);
    if (is_too_long)
      {
        state.estimates.mode.is_known = true;
        state.estimates.mode.force    = trial.force;
        throw StepRejected("accelerations show a mode of the grid that is "
                           "too fast");
      }
  }



  template <int dim>
  void
  CentralDifferences<dim>::advance(State<dim> &state, const double dt)
  {
    if (may_reject())
      {
        std::swap(state.acceleration, trial.acceleration);
        step_size.remember(state, trial.acceleration, dt);
      }
    else
      find_acceleration(state);
    begin_row(state);
    find_new_velocity(state);
    const VectorField<dim> *const a = &trial.acceleration;
    const VectorField<dim> *const v = &trial.new_velocity;
    switch (order)
      {
        case StressUpdate::USL:
          update(state, a, v, v, true);
          break;
        case StressUpdate::USF:
          update(state, a, v, nullptr, true);
          break;
        case StressUpdate::MUSL:
          update(state, a, v, nullptr, false);
          map_kicked_points(state);
          update(state, nullptr, v, &work_field, true);
          break;
      }
    add_work_of_point_loads(state, true);
    end_row(state);
    const std::string problem =
      discretization.transport_points(state,
                                      trial.motion.left_cells,
                                      trial.motion.left_surface_cells);
    fail_on_all(trial.motion.problem.empty() ? problem : trial.motion.problem,
                discretization.communicator());
    tell_guard(state);

    state.signals = signals();
    std::swap(state.velocity, trial.new_velocity);
    std::swap(state.acceleration, trial.acceleration);
    state.time += dt;
    state.velocity_time += trial.velocity_step;
    state.step          = dt;
    state.velocity_step = trial.velocity_step;
    state.n_iterations  = trial.n_iterations;
    state.n_all_iterations += trial.n_all_iterations;
    ++state.n_steps;
  }



  template class CentralDifferences<2>;
  template class CentralDifferences<3>;
} // namespace greville

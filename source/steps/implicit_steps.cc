// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/base/step_errors.h>
#include <greville/steps/coupled_steps.h>
#include <greville/steps/step_size.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  ImplicitSteps<dim>::ImplicitSteps(const std::string          &name,
                                    const IntegratorParts<dim> &parts)
    : parameters(parts.parameters)
    , discretization(parts.discretization)
    , loads(parts.loads)
    , log(parts.log)
    , guard(parts.guard)
    , scheme(make_implicit_scheme(name, parameters.implicit))
    , system(
        discretization.hierarchy(),
        [this](const SplineSpace<dim> &space) {
          return constrained_components_at_walls(space, discretization.walls());
        },
        parameters.implicit_solver,
        parameters.scheme.filling_threshold(true),
        parameters.scheme.has_lumped_mass(),
        discretization.volume_projection(),
        discretization.cell_windows())
  {
    check_parameters(name, parts);
    step_formula.emplace(parameters.time.step,
                         "Time/Step",
                         std::vector<std::string>{"h", "p"});
    is_symmetric = true;
    for (const Body<dim> &body : parts.initial.bodies)
      is_symmetric = is_symmetric && body.material->has_symmetric_tangent();
    for (auto *field : {&velocity,
                        &acceleration,
                        &displacement,
                        &constrained_momentum,
                        &old_force,
                        &old_loads,
                        &new_loads,
                        &force,
                        &work,
                        &surface_velocity,
                        &old_surface_loads,
                        &new_surface_loads,
                        &contact_load,
                        &contact_acceleration})
      discretization.initialize(*field);
    if (!parameters.general.pore_water)
      return;
    water = std::make_unique<PoreWater<dim>>(system.space(),
                                             discretization.triangulation(),
                                             parameters);
    discretization.initialize(water_force);
    // With a common IC(0) for all components, p = 3 takes four times as many
    // iterations, and ten times as many in nearly undrained soil.
    system.smooth_components();
  }



  template <int dim>
  double
  ImplicitSteps<dim>::propose_step(State<dim> &state)
  {
    if (state.n_rejections > 0)
      {
        // The last trial is a step of the smallest length.
        const double smallest = parameters.implicit.smallest_step;
        if (state.step_fraction <= smallest)
          throw StepFailed(describe_failure(state), false);
        state.step_fraction = std::max(0.5 * state.step_fraction, smallest);
      }
    const double step = evaluate_step(*step_formula,
                                      parameters.time,
                                      discretization.cell_size(),
                                      system.space().degree());
    const double left = parameters.time.end - state.time;
    check_step(step, left, parameters.time, [&]() {
      return "'Time/Step' is <" + formula_text(parameters.time.step) + ">.";
    });
    return left /
           std::max(1., std::ceil(left / (step * state.step_fraction) - 1e-9));
  }



  template <int dim>
  void
  ImplicitSteps<dim>::sum_loads(State<dim>       &state,
                                const double      t,
                                const bool        with_following,
                                VectorField<dim> &sums)
  {
    Tensor<1, dim> g;
    fail_with([&]() { g = loads.gravity(t); }, false);
    if (loads.act_on_points())
      {
        run_or_fail(discretization.communicator(),
                    [&]() { loads.set(state.bodies, t, with_following); });
        discretization.sum(state, true);
        for (unsigned int d = 0; d < dim; ++d)
          sums[d].copy_locally_owned_data_from(field().force[d]);
      }
    for (unsigned int d = 0; d < dim; ++d)
      {
        if (loads.act_on_points())
          sums[d] -= old_force[d];
        else
          sums[d] = 0.;
        sums[d].add(g[d], field().lumped_mass);
      }
  }



  template <int dim>
  void
  ImplicitSteps<dim>::begin_trial(State<dim> &state, const double dt)
  {
    take_bodies(state, dt);
    renew_mass(state);
    begin_water(state, dt);
    sum_forces(state, dt);
    set_contact_impulses_apart(state);
    map_velocity(state, dt);
    start_surfaces(state, dt);
    map_acceleration(state, dt);
    inertia_at_begin = find_inertia_at_begin(dt);
    guess_displacement(state, dt);
    n_linear = n_all_linear = 0;
  }



  template <int dim>
  void
  ImplicitSteps<dim>::take_bodies(const State<dim> &state, const double dt)
  {
    bodies.clear();
    for (const Body<dim> &body : state.bodies)
      bodies.push_back({&body.points,
                        body.material,
                        body.name,
                        body.material->strength_reduction(state.time + dt),
                        state.time + dt});
  }



  template <int dim>
  void
  ImplicitSteps<dim>::renew_mass(const State<dim> &state)
  {
    // The mass of total Lagrangian steps never changes.
    if (points_version != 0 && (points_version == state.points_version ||
                                parameters.scheme.is_total_lagrangian()))
      return;
    const PartTimer timer(log, "mass");
    system.set_points(bodies, state.surfaces, scheme.is_static);
    system.initialize(last_residual);
    if (water)
      water->set_points(state.bodies, state.surfaces);
    check_support(state);
    points_version = state.points_version;
  }



  template <int dim>
  void
  ImplicitSteps<dim>::begin_water(State<dim> &state, const double dt)
  {
    if (water)
      fail_with(
        [&]() {
          water->begin_step(state.bodies,
                            state.surfaces,
                            state.time + dt,
                            dt,
                            loads.gravity(state.time + dt),
                            state.water_step);
        },
        false);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::sum_forces(State<dim> &state, const double dt)
  {
    // The force of the stresses at the start, with its sign in M a = F - f.
    loads.clear(state.bodies);
    loads.surfaces().clear(state.surfaces);
    discretization.sum(state, true);
    for (unsigned int d = 0; d < dim; ++d)
      old_force[d].copy_locally_owned_data_from(field().force[d]);
    sum_loads(state, state.time, true, old_loads);
    sum_loads(state, state.time + scheme.load_time * dt, false, new_loads);
    if (water)
      {
        water->begin_force(water_force);
        for (unsigned int d = 0; d < dim; ++d)
          old_force[d] -= water_force[d];
      }
  }



  template <int dim>
  void
  ImplicitSteps<dim>::set_contact_impulses_apart(const State<dim> &state)
  {
    contact_force = nullptr;
    for (unsigned int d = 0; d < dim && scheme.needs_acceleration(); ++d)
      {
        contact_load[d] = 0.;
        for (unsigned int k = 0; k < state.surfaces.size(); ++k)
          if (!state.surfaces[k].contact.empty())
            contact_load[d] += field().surface_forces[k][d];
        old_force[d] -= contact_load[d];
      }
  }



  template <int dim>
  std::array<WallTime, 2>
  ImplicitSteps<dim>::wall_times(const double t, const double dt) const
  {
    const double difference = 1e-3 * dt, end = t + dt;
    return {
      {{t, std::max(t - difference, parameters.time.start), t + difference},
       {end, end - difference, end}}};
  }



  template <int dim>
  void
  ImplicitSteps<dim>::map_velocity(const State<dim> &state, const double dt)
  {
    velocity = state.field.velocity;
    discretization.walls().impose_velocity(velocity,
                                           wall_times(state.time, dt)[0]);
    if (scheme.is_static)
      return;
    solve_mass(velocity, field().momentum);
    system.finest().extended().constrained_rows(constrained_momentum,
                                                velocity,
                                                field().momentum);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::map_acceleration(State<dim> &state, const double dt)
  {
    for (VectorType &component : acceleration)
      component = 0.;
    if (scheme.is_static)
      return;
    if (scheme.needs_acceleration())
      {
        if (scheme.keeps_acceleration && state.field.history.n > 0)
          acceleration = state.field.history.accelerations[0];
        const auto times = wall_times(state.time, dt);
        discretization.walls().impose_acceleration(acceleration,
                                                   times[0],
                                                   times[1],
                                                   dt);
        find_acceleration(state);
      }
    // The part of v + share (v' - v) that does not depend on u.
    const double share = scheme.load_time;
    for (unsigned int d = 0; d < dim && !surfaces.empty(); ++d)
      {
        surface_velocity[d].equ(1. - share * scheme.gamma * scheme.alpha_v,
                                velocity[d]);
        surface_velocity[d].add(
          share * dt * (1. - scheme.gamma - scheme.gamma * scheme.alpha_a),
          acceleration[d]);
      }
  }



  template <int dim>
  void
  ImplicitSteps<dim>::guess_displacement(const State<dim> &state,
                                         const double      dt)
  {
    // Walls move by their displacement or, in the midpoint rule, with their
    // velocity in the middle of the step.
    for (unsigned int d = 0; d < dim; ++d)
      displacement[d].equ(dt, velocity[d]);
    discretization.walls().impose_velocity(
      work, {state.time + 0.5 * dt, state.time, state.time + dt});
    const auto &constrained = system.finest().constrained_components();
    for (unsigned int i = 0; i < work[0].locally_owned_size(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        if ((constrained[i] >> d) & 1)
          displacement[d].local_element(i) = dt * work[d].local_element(i);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::start_surfaces(const State<dim> &state, const double dt)
  {
    const double t = state.time + scheme.load_time * dt;
    surfaces       = loads.surfaces().loaded(state.surfaces, t);
    for (LoadedSurface<dim> &body : loads.following(state.bodies, t))
      surfaces.push_back(std::move(body));
    if (surfaces.empty())
      return;
    SurfaceMotion<dim> begin;
    begin.v = scheme.is_static ? nullptr : &velocity;
    for (VectorType &component : displacement)
      component = 0.;
    system.surfaces().add(loads.surfaces().loaded(state.surfaces, state.time),
                          displacement,
                          begin,
                          false,
                          old_surface_loads);
    for (unsigned int d = 0; d < dim; ++d)
      old_loads[d] += old_surface_loads[d];
    surface_motion.share = scheme.load_time;
    surface_motion.v     = scheme.is_static ? nullptr : &surface_velocity;
    surface_motion.v_by_u =
      scheme.load_time * scheme.gamma * scheme.alpha_u / dt;
  }



  template <int dim>
  void
  ImplicitSteps<dim>::try_step(State<dim> &state, const double dt)
  {
    CoupledSteps<dim>({{this, &state}}, nullptr, dt).try_step();
  }



  template <int dim>
  void
  ImplicitSteps<dim>::advance(State<dim> &state, const double dt)
  {
    take_contact_force();
    find_reactions(state, dt);
    keep_acceleration(state, dt);
    take_new_velocity(state, dt);
    take_constrained_momentum(state, dt);
    advance_water(state, dt);
    move_points(state, dt);
    count_step(state, dt);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::take_contact_force()
  {
    if (!contact_force)
      return;
    for (unsigned int d = 0; d < dim; ++d)
      contact_load[d].equ(1. / scheme.contact_weight(), (*contact_force)[d]);
    if (!scheme.needs_acceleration() || !find_contact_acceleration())
      contact_force = nullptr;
  }



  template <int dim>
  void
  ImplicitSteps<dim>::take_new_velocity(State<dim> &state, const double dt)
  {
    if (!scheme.is_static)
      find_new_acceleration(work, dt);
    for (unsigned int d = 0; d < dim; ++d)
      {
        VectorType &change = work[d];
        if (scheme.is_static)
          change = 0.;
        else
          {
            change *= scheme.gamma;
            change.add(1. - scheme.gamma, acceleration[d]);
            if (contact_force)
              change += contact_acceleration[d];
          }
        state.field.acceleration[d].copy_locally_owned_data_from(change);
        velocity[d].add(dt, change);
        displacement[d] *= 1. / dt;
        state.field.velocity[d].copy_locally_owned_data_from(
          scheme.is_static ? displacement[d] : velocity[d]);
      }
  }



  template <int dim>
  void
  ImplicitSteps<dim>::advance_water(State<dim> &state, const double dt)
  {
    if (!water)
      return;
    // Count the work of the pore pressure on the soil as a load, since bodies
    // store its energy.
    state.energy.add_work(EnergyBalance::loads, water->work());
    state.water_of_step = water->advance(state.bodies, state.water_of_step);
    state.water_step    = dt;
    for (unsigned int k = 0; k < state.water.size(); ++k)
      state.water[k] += state.water_of_step[k];
  }



  template <int dim>
  void
  ImplicitSteps<dim>::count_step(State<dim> &state, const double dt) const
  {
    state.time += dt;
    state.velocity_time = state.time;
    state.step          = dt;
    state.velocity_step = dt;
    state.n_iterations  = n_linear;
    state.n_all_iterations += n_all_linear;
    ++state.n_steps;
    // The length of cut steps doubles after an easy step.
    constexpr unsigned int easy_iterations = 6;
    if (n_newton <= easy_iterations)
      state.step_fraction = std::min(1., 2. * state.step_fraction);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::move_points(State<dim> &state, const double dt)
  {
    const PartTimer  timer(log, "grid to points");
    PointUpdate<dim> kick;
    kick.acceleration  = &state.field.acceleration;
    kick.velocity      = &velocity;
    kick.velocity_step = dt;
    kick.flip          = discretization.flip_share(state, dt);
    const auto pass    = [&](const PointUpdate<dim> &update) {
      return update_points(state.bodies,
                           discretization.transfer(),
                           update,
                           state.time + dt);
    };
    PointUpdate<dim> move;
    move.velocity    = &displacement;
    move.deformation = &displacement;
    move.move        = true;
    move.step        = dt;
    move.projection  = discretization.volume_projection();
    MomentumBalance<dim> momentum;
    if (scheme.is_static)
      stop_points(state);
    else
      {
        const VectorType &lumped = field().lumped_mass;
        momentum.add(field().momentum, kick.flip);
        momentum.add(lumped, state.field.acceleration, kick.flip * dt);
        momentum.add(lumped, velocity, 1. - kick.flip);
        if (kick.flip != 1.)
          pass(kick);
      }
    // A kick of FLIP does not need the velocity of the grid.
    PointUpdate<dim> last = move;
    if (!scheme.is_static && kick.flip == 1.)
      {
        last.acceleration  = kick.acceleration;
        last.velocity_step = dt;
      }
    PointMotion motion = pass(last);
    for (const PointUpdate<dim> *update : {&kick, &move})
      if (update == &move || !scheme.is_static)
        update_surfaces(state.surfaces,
                        discretization.transfer(),
                        *update,
                        motion);
    state.points_have_changed();
    discretization.transport_points(state, motion);
    guard.set(motion);
    guard.set(momentum);
    std::vector<double> speeds{motion.fastest_signal, motion.fastest_wave};
    Utilities::MPI::max(speeds, discretization.communicator(), speeds);
    state.signals.fastest = speeds[0];
    state.signals.wave    = speeds[1];
  }



  GREVILLE_INSTANTIATE_CLASS(ImplicitSteps);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/step_errors.h>
#include <greville/steps/central_differences.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The tolerance for accelerations is relative to the change of velocities
    // in a step, or to this fraction of their norm if the change is smaller.
    constexpr double negligible_kick = 1e-6;

    // The time increment in the difference quotient of a displacement, as a
    // fraction of the step.
    constexpr double moment = 1e-3;
  } // namespace



  template <int dim>
  CentralDifferences<dim>::CentralDifferences(const IntegratorParts<dim> &parts)
    : parameters(parts.parameters)
    , discretization(parts.discretization)
    , field(discretization.field())
    , walls(discretization.walls())
    , loads(parts.loads)
    , log(parts.log)
    , guard(parts.guard)
    , late_row(parts.late_row)
    , apic(parameters.scheme.is_apic())
    , taylor(parameters.scheme.is_taylor())
    , half_steps(parameters.time.has_half_steps())
    , contacts(make_contacts(parts))
    , damping(parameters.loads)
    , step_size(parameters.time, discretization, log)
  {
    for (const auto &contact : contacts)
      have_constraints = have_constraints || contact->constrains();
    if (field.mass->is_exact())
      filter.reinit(discretization.space());
    for (auto *values : {&field.velocity,
                         &field.acceleration,
                         &field.new_velocity,
                         &work_field})
      discretization.initialize(*values);
    if (parameters.general.pore_water)
      water = std::make_unique<FractionalStep<dim>>(discretization, parameters);
  }



  template <int dim>
  double
  CentralDifferences<dim>::propose_step(State<dim> &state)
  {
    StepScheme scheme;
    scheme.deforms_by_mapped_velocity = deforms_by_mapped_velocity();
    scheme.has_affine                 = apic || taylor;
    // A smaller FLIP share has a shorter critical step. As dt is not known yet,
    // use the smallest share.
    scheme.flip =
      std::min(parameters.scheme.flip,
               discretization.flip_share(state, state.velocity_step));
    scheme.damping = damping.factor();
    return step_size.propose(state, scheme);
  }



  template <int dim>
  void
  CentralDifferences<dim>::solve(
    const std::vector<VectorField<dim> *>       &x,
    const std::vector<const VectorField<dim> *> &sums,
    const std::vector<double>                   &shares)
  {
    const unsigned int n = discretization.solve(x, sums, shares);
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
  ContactStep<dim>
  CentralDifferences<dim>::contact_step(State<dim> &state)
  {
    const double     begin = state.velocity_time;
    ContactStep<dim> step{state,
                          field,
                          discretization.transfer(),
                          begin,
                          begin + trial.velocity_step,
                          trial.velocity_step};
    step.row = row;
    return step;
  }



  template <int dim>
  void
  CentralDifferences<dim>::constrain(State<dim> &state)
  {
    if (!have_constraints)
      return;
    field.constraints.clear(discretization.space().owned_functions().size());
    ContactStep<dim> step = contact_step(state);
    for (const auto &contact : contacts)
      contact->constrain(step);
    field.mass->constrain(field.constraints);
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_gravity(const double t)
  {
    const Tensor<1, dim> g = loads.gravity(t);
    for (unsigned int d = 0; d < dim; ++d)
      if (g[d] != 0.)
        for (unsigned int i = 0; i < field.lumped_mass.locally_owned_size();
             ++i)
          field.force[d].local_element(i) +=
            g[d] * field.lumped_mass.local_element(i);
  }



  template <int dim>
  void
  CentralDifferences<dim>::begin_step(State<dim> &state)
  {
    // The work of gravity contains its values at both ends of the step.
    fail_with(
      [&]() {
        loads.gravity(state.time);
        loads.gravity(state.time + trial.step);
      },
      false);
    const PartTimer timer(log, "loads");
    if (loads.act_on_points() || !state.surfaces.empty())
      run_or_fail(discretization.communicator(), [&]() {
        loads.set(state.bodies, state.time);
        loads.surfaces().set(state.surfaces, state.time);
      });
  }



  template <int dim>
  void
  CentralDifferences<dim>::set_guesses(State<dim> &state)
  {
    const WallTime after  = wall_time(state);
    WallTime       before = after;
    before.t              = state.velocity_time;
    if (state.step > 0.)
      {
        before.begin = state.time - state.step;
        before.end   = state.time;
      }
    trial.momentum.add(field.momentum, 1.);
    field.velocity = state.field.velocity;
    std::swap(field.acceleration, state.field.acceleration);
    walls.impose_velocity(field.velocity, before);
    walls.impose_acceleration(field.acceleration,
                              before,
                              after,
                              trial.velocity_step);
  }



  template <int dim>
  void
  CentralDifferences<dim>::find_fields(State<dim> &state)
  {
    const double dt    = trial.velocity_step;
    const double share = kept_share(state);
    discretization.sum(state, true);
    set_guesses(state);
    constrain(state);
    add_gravity(state.time);
    // Do not solve for forces that are only round-off.
    solve({&field.velocity, &field.acceleration},
          {&field.momentum, &field.force},
          {1., dt > 0. ? negligible_kick / dt : 0.});
    add_momentum_of_walls(field.velocity, field.momentum, 0, 1. - share);
    add_momentum_of_walls(field.acceleration, field.force, 1, dt);
  }



  template <int dim>
  void
  CentralDifferences<dim>::find_acceleration(State<dim> &state)
  {
    begin_step(state);
    field.momentum_of_walls = {};
    trial.momentum          = {};
    find_fields(state);
    trial.momentum.add(field.force, trial.velocity_step);
    damping.damp(field);
    if (water)
      add_pressure(state);
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_pressure(const State<dim> &state)
  {
    const PartTimer timer(log, "water");
    fail_with(
      [&]() {
        const unsigned int n =
          water->add_pressure(state,
                              loads.gravity(state.time + trial.step),
                              trial.step,
                              trial.velocity_step,
                              field);
        trial.n_iterations = std::max(trial.n_iterations, n);
        trial.n_all_iterations += n;
      },
      false);
    trial.momentum.add(water->forces(), -trial.velocity_step);
  }



  template <int dim>
  void
  CentralDifferences<dim>::filter_velocity()
  {
    if (!field.mass->is_exact() || parameters.scheme.filter == 0. ||
        parameters.scheme.is_total_lagrangian())
      return;
    const PartTimer   timer(log, "filter");
    const VectorType &lumped = field.lumped_mass;
    filter.set_mass(lumped);
    VectorField<dim> &correction = work_field;
    filter.apply(correction,
                 field.new_velocity,
                 parameters.scheme.filter,
                 trial.step);
    field.mass->extend(correction);
    // Without walls, the filter conserves momentum.
    walls.add_constrained(field.momentum_of_walls,
                          [&](const unsigned int c, const unsigned int i) {
                            return -lumped.local_element(i) *
                                   correction[c].local_element(i);
                          });
    for (unsigned int d = 0; d < dim; ++d)
      {
        VectorType &z = correction[d];
        for (unsigned int i = 0; i < z.locally_owned_size(); ++i)
          if ((field.mass->constrained_components(i) >> d) & 1)
            z.local_element(i) = 0.;
        field.new_velocity[d] += z;
        field.acceleration[d].add(1. / trial.velocity_step, z);
      }
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_contact(State<dim> &state)
  {
    ContactStep<dim> step = contact_step(state);
    for (const auto &contact : contacts)
      contact->apply(step);
    if (contacts.empty())
      return;
    field.mass->distribute_levels(field.new_velocity);
    field.mass->distribute_levels(field.acceleration);
  }



  template <int dim>
  void
  CentralDifferences<dim>::take_constrained_residual(const State<dim> &state)
  {
    if (!parameters.scheme.is_flip() || !(trial.velocity_step > 0.))
      return;
    field.mass->constrained_residual(work_field,
                                     field.momentum,
                                     field.velocity);
    for (unsigned int d = 0; d < dim; ++d)
      field.acceleration[d].add(-1. / trial.velocity_step, work_field[d]);
    const double share = kept_share(state);
    walls.add_constrained(field.momentum_of_walls,
                          [&](const unsigned int c, const unsigned int i) {
                            return -share * field.lumped_mass.local_element(i) *
                                   work_field[c].local_element(i);
                          });
  }



  template <int dim>
  void
  CentralDifferences<dim>::find_new_velocity(State<dim> &state)
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        field.new_velocity[d] = field.velocity[d];
        field.new_velocity[d].add(trial.velocity_step, field.acceleration[d]);
      }
    filter_velocity();
    add_contact(state);
    if (trial.step == 0.)
      state.field.acceleration = field.acceleration;
    take_constrained_residual(state);
    for (unsigned int w = 0; w < 2 * dim && trial.velocity_step > 0.; ++w)
      state.reactions[w] = field.momentum_of_walls[w] / trial.velocity_step;
    add_work(state);
    add_work_of_damping(state);
  }



  template <int dim>
  void
  CentralDifferences<dim>::finish(State<dim> &state)
  {
    // Apply the rest of the kick at the current positions of the points.
    if (!velocities_are_late(state))
      return;
    // Forget factorizations, so that finishing a step twice gives equal
    // results.
    field.mass->forget();
    const auto reactions = state.reactions;
    row                  = nullptr; // left by a failed step
    trial.step           = 0.;
    trial.velocity_step  = 0.5 * state.step;
    trial.motion         = PointMotion();
    find_acceleration(state);
    find_new_velocity(state);
    update(state,
           &GridField<dim>::acceleration,
           &GridField<dim>::new_velocity,
           nullptr,
           false);
    add_work_of_point_loads(state, true);
    fail_on_all(trial.motion.problem, discretization.communicator());
    state.field.velocity = field.new_velocity;
    state.reactions      = reactions;
    state.velocity_time  = state.time;
  }



  template <int dim>
  double
  CentralDifferences<dim>::energy_swing(const State<dim> &state) const
  {
    // MUSL with lumped mass or FMPM damps high modes and conserves a different
    // energy.
    if (!field.mass->is_exact() && deforms_by_mapped_velocity())
      return 0.;
    double square = 0.; // a^T M a
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < field.force[d].locally_owned_size(); ++i)
        square += field.acceleration[d].local_element(i) *
                  field.force[d].local_element(i);
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
    row->energy_swing = energy_swing(state);
    row->is_known     = true;
    row               = nullptr;
  }



  template <int dim>
  void
  CentralDifferences<dim>::try_step(State<dim> &state, const double dt)
  {
    const double last   = velocities_are_late(state) ? state.step : 0.;
    trial.step          = dt;
    trial.velocity_step = half_steps ? 0.5 * (last + dt) : dt;
    trial.motion        = PointMotion();
    if (state.n_rejections == 0)
      trial.n_iterations = trial.n_all_iterations = 0;
    if (!may_reject())
      return;
    find_acceleration(state);
    FieldState<dim> &kept = state.field;
    // Accept a step that has been rejected before.
    const bool is_too_long =
      state.n_rejections == 0 &&
      step_size.has_unstable_mode(state, kept, field, dt);
    if (is_too_long)
      {
        kept.mode.is_known = true;
        kept.mode.force    = field.force;
      }
    // Keep the guess for the next trial.
    std::swap(kept.acceleration, field.acceleration);
    if (is_too_long)
      throw StepRejected("accelerations show a mode of the grid that is "
                         "too fast");
  }



  template <int dim>
  void
  CentralDifferences<dim>::advance(State<dim> &state, const double dt)
  {
    take_acceleration(state, dt);
    begin_row(state);
    find_new_velocity(state);
    if (water)
      water->advance(state);
    take_points(state);
    add_work_of_point_loads(state, true);
    end_row(state);
    discretization.transport_points(state, trial.motion);
    inform_guard();
    count_step(state, dt);
  }



  template <int dim>
  void
  CentralDifferences<dim>::take_acceleration(State<dim> &state, const double dt)
  {
    if (!may_reject())
      {
        find_acceleration(state);
        return;
      }
    std::swap(state.field.acceleration, field.acceleration);
    step_size.remember(state.field.history, field.acceleration, dt);
  }



  template <int dim>
  void
  CentralDifferences<dim>::count_step(State<dim> &state, const double dt)
  {
    state.signals = signals();
    std::swap(state.field.velocity, field.new_velocity);
    std::swap(state.field.acceleration, field.acceleration);
    state.time += dt;
    state.velocity_time += trial.velocity_step;
    state.step          = dt;
    state.velocity_step = trial.velocity_step;
    state.n_iterations  = trial.n_iterations;
    state.n_all_iterations += trial.n_all_iterations;
    ++state.n_steps;
  }



  GREVILLE_INSTANTIATE_CLASS(CentralDifferences);
} // namespace greville

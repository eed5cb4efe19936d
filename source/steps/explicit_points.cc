// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/central_differences.h>

#include <algorithm>
#include <cmath>

// Motion of points in CentralDifferences after a solve, and its balances of
// energy and momentum.
namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  CentralDifferences<dim>::update(State<dim>  &state,
                                  const Member kick,
                                  const Member velocity,
                                  const Member deformation,
                                  const bool   move)
  {
    const PartTimer  timer(log, "grid to points");
    PointUpdate<dim> update;
    update.move          = move;
    update.velocity_step = trial.velocity_step;
    update.step          = trial.step;
    update.flip       = discretization.flip_share(state, trial.velocity_step);
    update.apic       = apic;
    update.taylor     = taylor;
    update.projection = discretization.volume_projection();

    const bool watches = row && kick && row->watch;
    if (watches)
      row->watch(1. - row->fraction, false);
    update.acceleration = kick ? &(field.*kick) : nullptr;
    update.velocity     = velocity ? &(field.*velocity) : nullptr;
    update.deformation  = deformation ? &(field.*deformation) : nullptr;
    if (row && kick && row->show)
      show(state, update);
    PointMotion motion = update_points(state.bodies,
                                       discretization.transfer(),
                                       update,
                                       state.time + (move ? trial.step : 0.),
                                       row);
    update_surfaces(state, update, motion);
    if (watches)
      row->watch(row->fraction, true);
    motion.merge(trial.motion);
    trial.motion = std::move(motion);
    state.points_have_changed();
  }



  template <int dim>
  void
  CentralDifferences<dim>::show(State<dim> &state, PointUpdate<dim> kick)
  {
    const KickedNumbers<dim> before(state.bodies);
    kick.deformation = nullptr;
    kick.move        = false;
    update_points(state.bodies, discretization.transfer(), kick, state.time);
    before.restore(state.bodies, 1. - row->fraction);
    // These fields are replaced at the end of the step.
    for (unsigned int d = 0; d < dim; ++d)
      {
        VectorType &v = state.field.velocity[d],
                   &a = state.field.acceleration[d];
        v             = field.velocity[d];
        a             = field.new_velocity[d];
        a -= v;
        v.add(row->fraction, a);
        a *= 1. / trial.velocity_step;
      }
    const auto   rigid_bodies  = state.rigid_bodies;
    const double velocity_time = state.velocity_time;
    for (RigidBodyState<dim> &body : state.rigid_bodies)
      body.now = body.before;
    state.velocity_time = state.time;
    row->show();
    state.velocity_time = velocity_time;
    state.rigid_bodies  = rigid_bodies;
    before.restore(state.bodies);
  }



  template <int dim>
  void
  CentralDifferences<dim>::update_surfaces(State<dim>             &state,
                                           const PointUpdate<dim> &update,
                                           PointMotion            &motion)
  {
    if (state.surfaces.empty())
      return;
    PointTransfer<dim> &transfer = discretization.transfer();
    PointUpdate<dim>    move     = update;
    if (field.mass->extends_surfaces())
      {
        const VectorField<dim> **const given[3] = {&move.velocity,
                                                   &move.acceleration,
                                                   &move.deformation};
        for (unsigned int k = 0; k < 3; ++k)
          if (*given[k])
            {
              surface_fields[k] = **given[k];
              field.mass->distribute(surface_fields[k]);
              *given[k] = &surface_fields[k];
            }
      }
    if (update.acceleration)
      {
        const double lag =
          std::max(0.,
                   state.time + trial.step - state.velocity_time -
                     trial.velocity_step);
        for (unsigned int d = 0; d < dim; ++d)
          {
            surface_velocity[d] = (*move.velocity)[d];
            surface_velocity[d].add(lag, (*move.acceleration)[d]);
          }
        PointUpdate<dim> kick = move;
        kick.velocity         = &surface_velocity;
        kick.deformation      = nullptr;
        kick.move             = false;
        greville::update_surfaces(state.surfaces, transfer, kick, motion);
        move.acceleration = nullptr;
      }
    if (move.move || move.deformation)
      greville::update_surfaces(state.surfaces, transfer, move, motion);
  }



  namespace
  {
    /// Return the size of the smallest cell on which a function does not
    /// vanish. In refined grids, functions reach into cells of the next level.
    template <int dim>
    double
    smallest_cell_at(const SplineSpace<dim> &space,
                     const unsigned int      i,
                     const unsigned int      d)
    {
      const double h = space.smallest_cell_of(i, d);
      return space.hierarchy() ? std::max(0.5 * h, space.cell_size(d)) : h;
    }
  } // namespace



  template <int dim>
  Signals
  CentralDifferences<dim>::signals() const
  {
    const SplineSpace<dim> &space = discretization.space();
    std::vector<double>     rates = {trial.motion.fastest_signal,
                                     trial.motion.fastest_wave,
                                     0.};
    const bool points_cross_cells = !parameters.scheme.is_total_lagrangian();
    const bool is_uniform         = space.is_uniform();
    // Cells per length, by functions of a direction.
    std::array<std::vector<double>, dim> inverse_h;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < space.n_functions()[d]; ++i)
        inverse_h[d].push_back(1. / smallest_cell_at(space, i, d));
    const std::size_t n =
      points_cross_cells ? space.owned_functions().size() : 0;
    for (std::size_t i = 0; i < n; ++i)
      if (field.mass->is_stable(i))
        {
          const MultiIndex<dim> index =
            is_uniform ? MultiIndex<dim>{}
                       : multi_index<dim>(space.owned_functions()[i],
                                          space.n_functions());
          double rate = 0.;
          for (unsigned int d = 0; d < dim; ++d)
            rate += std::abs(field.new_velocity[d].local_element(i)) *
                    inverse_h[d][index[d]];
          rates[2] = std::max(rates[2], rate);
        }
    Utilities::MPI::max(rates, discretization.communicator(), rates);
    return {rates[0], rates[1], rates[2]};
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_work(State<dim> &state)
  {
    // The potential of gravity depends on positions: use the mean of gravity
    // over the step.
    const Tensor<1, dim> g     = 0.5 * (loads.gravity(state.time) +
                                    loads.gravity(state.time + trial.step));
    double               power = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      if (g[d] != 0.)
        for (unsigned int i = 0; i < field.lumped_mass.locally_owned_size();
             ++i)
          power += g[d] * field.lumped_mass.local_element(i) *
                   field.new_velocity[d].local_element(i);
    state.energy.add_work(EnergyBalance::gravity, trial.step * power);

    // Loads change the kinetic energy.
    add_work_of_point_loads(state, false);
    for (unsigned int k = 0; k < state.surfaces.size(); ++k)
      {
        const VectorField<dim> &force  = field.surface_forces[k];
        const unsigned int      source = EnergyBalance::surfaces + k;
        double                  before = 0., after = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int i = 0; i < force[d].locally_owned_size(); ++i)
            {
              const double impulse =
                trial.velocity_step * force[d].local_element(i);
              before += impulse * field.velocity[d].local_element(i);
              after += impulse * field.new_velocity[d].local_element(i);
            }
        state.energy.add_work(source, 0.5 * (before + after));
        if (row)
          row->energy.add_work(source, row->part_of_work(before, after));
      }

    // Walls and constraining contacts supply the difference between the force
    // for a = (v' - v) / dt' and the sum of forces.
    if ((walls.have_moving() || have_constraints) && trial.velocity_step > 0.)
      {
        double power_of_walls = 0.;
        field.mass->constrained_residual(work_field,
                                         field.force,
                                         field.acceleration);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int i = 0; i < field.lumped_mass.locally_owned_size();
               ++i)
            power_of_walls -= field.lumped_mass.local_element(i) *
                              work_field[d].local_element(i) *
                              field.new_velocity[d].local_element(i);
        state.energy.add_work(EnergyBalance::walls,
                              trial.step * power_of_walls);
      }
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_work_of_point_loads(State<dim> &state,
                                                   const bool  is_kicked)
  {
    if (!loads.act_on_points())
      return;
    double power = 0.;
    for (const Body<dim> &body : state.bodies)
      {
        const unsigned int load = body.points.layout().first("load");
        body.points.for_each([&](ConstPointRef<dim> p) {
          for (unsigned int d = 0; d < dim; ++d)
            power += p.mass() * p[load + d] * p.velocity(d);
        });
      }
    const double work = trial.velocity_step * power;
    state.energy.add_work(EnergyBalance::loads, 0.5 * work);
    if (row)
      row->energy.add_work(EnergyBalance::loads,
                           is_kicked ? row->part_of_work(0., work)
                                     : row->part_of_work(work, 0.));
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_work_of_damping(State<dim> &state)
  {
    // Only the guard needs this work; it costs a product with the mass matrix.
    if (damping.factor() == 0. || !parameters.scheme.looks_at_energy())
      return;
    const PartTimer timer(log, "energy");

    // The momenta P' of the points, or with APIC and Taylor of the grid.
    const double      dt   = trial.velocity_step;
    const double      flip = kept_share(state);
    VectorField<dim> &sum = surface_velocity, &momenta = work_field;
    const bool        is_of_grid = apic || taylor;
    if (!apic)
      discretization.sum(state);
    for (unsigned int d = 0; d < dim; ++d)
      {
        sum[d] = field.new_velocity[d];
        sum[d] *= 1. - flip;
        sum[d].add(flip * dt, field.acceleration[d]);
        if (is_of_grid)
          {
            momenta[d] = sum[d];
            momenta[d].scale(field.lumped_mass);
          }
      }
    if (!is_of_grid)
      discretization.transfer().multiply_mass(field.points, sum, momenta);
    for (unsigned int d = 0; d < dim; ++d)
      momenta[d].add(flip, field.momentum[d]);
    // The damping work with the momenta before and after the kick.
    const double before = 2. * dt * damping.power(field, field.momentum),
                 after  = 2. * dt * damping.power(field, momenta);
    state.energy.add_damping(0.5 * (before + after));
    if (row)
      row->energy.add_damping(row->part_of_work(before, after));
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_momentum_of_walls(const VectorField<dim> &x,
                                                 const VectorField<dim> &b,
                                                 const unsigned int      k,
                                                 const double            factor)
  {
    if (factor == 0.)
      return;
    field.mass->constrained_rows(work_field, x, b, k);
    walls.add_constrained(field.momentum_of_walls,
                          [&](const unsigned int c, const unsigned int i) {
                            return factor * work_field[c].local_element(i);
                          });
  }



  template <int dim>
  void
  CentralDifferences<dim>::inform_guard()
  {
    guard.set(trial.motion);
    // The momentum that constraints and damping remove is not known.
    if (have_constraints || damping.factor() != 0.)
      return;
    for (const Tensor<1, dim> &given : field.momentum_of_walls)
      trial.momentum.add(given);
    guard.set(trial.momentum);
  }



  GREVILLE_INSTANTIATE_CLASS(CentralDifferences);
} // namespace greville

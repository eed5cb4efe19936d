// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/central_differences.h>

// What CentralDifferences tells the balances of energy and momentum.
namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  CentralDifferences<dim>::add_work(State<dim> &state)
  {
    // The potential of gravity belongs to positions: its mean over the step.
    const VectorType    &lumped = discretization.lumped_mass();
    const Tensor<1, dim> g      = 0.5 * (loads.gravity(state.time) +
                                    loads.gravity(state.time + trial.step));
    double               power  = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      if (g[d] != 0.)
        for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
          power += g[d] * lumped.local_element(i) *
                   trial.new_velocity[d].local_element(i);
    state.energy.add_work(EnergyBalance::gravity, trial.step * power);

    // What their force gives to the kinetic energy.
    add_work_of_point_loads(state);
    for (unsigned int k = 0; k < state.surfaces.size(); ++k)
      {
        const VectorField<dim> &force = discretization.surface_forces()[k];
        double                  sum   = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
            sum += force[d].local_element(i) *
                   (trial.velocity[d].local_element(i) +
                    trial.new_velocity[d].local_element(i));
        state.energy.add_work(EnergyBalance::surfaces + k,
                              0.5 * trial.velocity_step * sum);
      }

    // Walls and obstacles give what a = (v' - v) / dt' needs beyond the force.
    if ((walls.have_moving() || obstacles) && trial.velocity_step > 0.)
      {
        double power_of_walls = 0., power_of_obstacles = 0.;
        mass.held_residual(work_field, trial.force, trial.acceleration);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
            ((mass.held_by_walls(i) >> d) & 1 ? power_of_walls
                                              : power_of_obstacles) -=
              lumped.local_element(i) * work_field[d].local_element(i) *
              trial.new_velocity[d].local_element(i);
        state.energy.add_work(EnergyBalance::walls,
                              trial.step * power_of_walls);
        state.energy.add_work(EnergyBalance::obstacles,
                              trial.step * power_of_obstacles);
      }
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_work_of_point_loads(State<dim> &state) const
  {
    if (!loads.act_on_points())
      return;
    double power = 0.;
    for (const Body<dim> *body : deformable_bodies(state.bodies))
      {
        const unsigned int load = body->points.layout().first("load");
        body->points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
          for (unsigned int d = 0; d < dim; ++d)
            power += p.mass() * p[load + d] * p.velocity(d);
        });
      }
    state.energy.add_work(EnergyBalance::loads,
                          0.5 * trial.velocity_step * power);
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_work_of_friction(State<dim> &state) const
  {
    const VectorType &lumped = discretization.lumped_mass();
    double            work   = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
        {
          const double change = trial.new_velocity[d].local_element(i) -
                                work_field[d].local_element(i);
          work += 0.5 * lumped.local_element(i) * change *
                  (trial.velocity[d].local_element(i) +
                   trial.new_velocity[d].local_element(i));
        }
    state.energy.add_friction(work);
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_work_of_damping(State<dim> &state)
  {
    // It is for the guard, and costs a product with the mass matrix.
    if (damping.factor() == 0. || parameters.scheme.energy_gain == "ignore")
      return;
    const PartTimer timer(log, "energy");

    // P + P' of the points. That of APIC is of the grid.
    const double      dt   = trial.velocity_step;
    const double      flip = kept_share(state);
    VectorField<dim> &sum = trial.velocity, &momenta = work_field;
    for (unsigned int d = 0; d < dim; ++d)
      {
        sum[d].equ(1. - flip, trial.new_velocity[d]);
        sum[d].add(flip * dt, trial.acceleration[d]);
        if (apic)
          {
            momenta[d] = sum[d];
            momenta[d].scale(discretization.lumped_mass());
          }
      }
    if (!apic)
      discretization.transfer().multiply_mass(discretization.sum(state),
                                              sum,
                                              momenta);
    for (unsigned int d = 0; d < dim; ++d)
      momenta[d].add(1. + flip, discretization.momentum()[d]);
    state.energy.add_damping(dt * damping.power(momenta, trial.force));
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
    mass.rows_of_held(work_field, x, b, k);
    walls.add_held(trial.momentum_of_walls,
                   [&](const unsigned int c, const unsigned int i) {
                     return factor * work_field[c].local_element(i);
                   });
  }



  template <int dim>
  void
  CentralDifferences<dim>::add_momentum_of_walls(const WallSums<dim> &momentum,
                                                 const double         factor)
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      trial.momentum_of_walls[w] += factor * momentum[w];
  }



  template <int dim>
  void
  CentralDifferences<dim>::tell_guard(const State<dim> &state)
  {
    guard.set(trial.motion);
    // Obstacles and damping take some that nobody adds up, and reconstructions
    // are not the points.
    if (obstacles || damping.factor() != 0. ||
        parameters.scheme.quadrature != "points")
      return;
    for (const Tensor<1, dim> &given : trial.momentum_of_walls)
      trial.momentum.add(given);
    guard.set(trial.momentum);
  }



  template class CentralDifferences<2>;
  template class CentralDifferences<3>;
} // namespace greville

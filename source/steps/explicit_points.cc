// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/central_differences.h>

#include <algorithm>
#include <cmath>

// What CentralDifferences does with points after a solve.
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
    update.step          = move ? trial.step : trial.deformation_step;
    update.flip          = flip_share(state, trial.velocity_step);
    update.apic          = apic;
    update.projection    = discretization.volume_projection();

    const bool watches = row && kick && row->watch;
    if (watches)
      row->watch(state.bodies, 1. - row->fraction, false);
    PointMotion motion;
    for (const GridField<dim> &field : discretization.fields())
      {
        update.acceleration = kick ? &(field.*kick) : nullptr;
        update.velocity     = velocity ? &(field.*velocity) : nullptr;
        update.deformation  = deformation ? &(field.*deformation) : nullptr;
        update_points_of(state.bodies,
                         field.bodies,
                         discretization.transfer(),
                         update,
                         state.time + (move ? trial.step : 0.),
                         row,
                         motion);
        update_surfaces(state, field, update, motion);
      }
    if (watches)
      row->watch(state.bodies, row->fraction, true);
    motion.merge(trial.motion);
    trial.motion = std::move(motion);
    if (kick || move)
      state.points_have_changed();
  }



  template <int dim>
  void
  CentralDifferences<dim>::update_surfaces(State<dim>             &state,
                                           const GridField<dim>   &field,
                                           const PointUpdate<dim> &update,
                                           PointMotion            &motion)
  {
    if (state.surfaces.empty())
      return;
    PointTransfer<dim> &transfer = discretization.transfer();
    PointUpdate<dim>    move     = update;
    if (update.acceleration)
      {
        const double lag =
          std::max(0.,
                   state.time + trial.step - state.velocity_time -
                     trial.velocity_step);
        for (unsigned int d = 0; d < dim; ++d)
          {
            surface_velocity[d] = (*update.velocity)[d];
            surface_velocity[d].add(lag, (*update.acceleration)[d]);
          }
        PointUpdate<dim> kick = update;
        kick.velocity         = &surface_velocity;
        kick.deformation      = nullptr;
        kick.move             = false;
        greville::update_surfaces(
          state.surfaces, field.surfaces, transfer, kick, motion);
        move.acceleration = nullptr;
      }
    if (move.move || move.deformation)
      greville::update_surfaces(
        state.surfaces, field.surfaces, transfer, move, motion);
  }



  template <int dim>
  Signals
  CentralDifferences<dim>::signals() const
  {
    const SplineSpace<dim> &space = discretization.space();
    std::vector<double>     rates = {trial.motion.fastest_signal,
                                     trial.motion.fastest_wave,
                                     0.};
    const bool points_cross_cells = !parameters.scheme.is_total_lagrangian();
    for (const GridField<dim> &field : discretization.fields())
      for (unsigned int i = 0;
           points_cross_cells && i < space.owned_functions().size();
           ++i)
        if (!field.consistent ||
            field.consistent->extension()[i] == Extension<dim>::stable)
          {
            double rate = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              rate += std::abs(field.new_velocity[d].local_element(i)) /
                      space.lattice().cell_size(d);
            rates[2] = std::max(rates[2], rate);
          }
    Utilities::MPI::max(rates, discretization.communicator(), rates);
    return {rates[0], rates[1], rates[2]};
  }



  template class CentralDifferences<2>;
  template class CentralDifferences<3>;
} // namespace greville

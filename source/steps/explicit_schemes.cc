// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/explicit_schemes.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  USL<dim>::take_points(State<dim> &state)
  {
    this->update(state,
                 &GridField<dim>::acceleration,
                 &GridField<dim>::new_velocity,
                 &GridField<dim>::new_velocity,
                 true);
  }



  template <int dim>
  void
  USF<dim>::find_fields(State<dim> &state)
  {
    const double    dt           = this->trial.velocity_step;
    const double    share        = this->kept_share(state);
    GridField<dim> &field        = this->field;
    const auto      map_velocity = [&]() {
      this->constrain(state);
      this->solve({&field.velocity}, {&field.momentum});
      field.momentum_of_walls = {};
      this->add_momentum_of_walls(field.velocity,
                                  field.momentum,
                                  0,
                                  1. - share);
      const WallSums<dim> stopped = this->stop(field.velocity);
      for (unsigned int w = 0; w < 2 * dim; ++w)
        field.momentum_of_walls[w] += (1. - share) * stopped[w];
    };
    this->discretization.sum(state);
    this->set_guesses(state);
    map_velocity();
    const auto stamp = state.points_stamp;
    this->update(state, nullptr, nullptr, &GridField<dim>::velocity, false);
    const bool functions_changed = state.points_stamp != stamp;
    this->discretization.sum(state, true);
    if (functions_changed)
      map_velocity();
    else
      this->constrain(state);
    this->add_gravity(state.time);
    this->solve({&field.acceleration}, {&field.force});
    this->add_momentum_of_walls(field.acceleration, field.force, 0, dt);
  }



  template <int dim>
  void
  USF<dim>::take_points(State<dim> &state)
  {
    this->update(state,
                 &GridField<dim>::acceleration,
                 &GridField<dim>::new_velocity,
                 nullptr,
                 true);
  }



  template <int dim>
  void
  MUSL<dim>::take_points(State<dim> &state)
  {
    this->update(state,
                 &GridField<dim>::acceleration,
                 &GridField<dim>::new_velocity,
                 nullptr,
                 false);
    this->discretization.sum_momentum(state);
    VectorField<dim> &w = this->field.velocity;
    w                   = this->field.new_velocity;
    this->walls.hold_velocity(w, this->wall_time(state));
    this->solve({&w}, {&this->field.momentum});
    this->stop(w);
    this->update(state,
                 nullptr,
                 &GridField<dim>::new_velocity,
                 &GridField<dim>::velocity,
                 true);
  }



  template class USL<2>;
  template class USL<3>;
  template class USF<2>;
  template class USF<3>;
  template class MUSL<2>;
  template class MUSL<3>;
} // namespace greville

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
    this->walls.impose_velocity(w, this->wall_time(state));
    this->solve({&w}, {&this->field.momentum});
    this->stop(w);
    this->update(state,
                 nullptr,
                 &GridField<dim>::new_velocity,
                 &GridField<dim>::velocity,
                 true);
  }



  GREVILLE_INSTANTIATE_CLASS(USL);
  GREVILLE_INSTANTIATE_CLASS(MUSL);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/step_errors.h>
#include <greville/steps/wall_friction.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    void
    add_to(WallSums<dim> &sums, const WallSums<dim> &more)
    {
      for (unsigned int w = 0; w < 2 * dim; ++w)
        sums[w] += more[w];
    }
  } // namespace



  template <int dim>
  FrictionWalls<dim>::FrictionWalls(const Walls<dim> &walls,
                                    GridField<dim>   &field)
    : walls(walls)
    , field(field)
  {}



  template <int dim>
  void
  FrictionWalls<dim>::stop(VectorField<dim> &velocity) const
  {
    walls.stop(velocity);
  }



  template <int dim>
  std::unique_ptr<Contact<dim>>
  LumpedWallFriction<dim>::make(const IntegratorParts<dim> &parts)
  {
    const Walls<dim> &walls = parts.discretization.walls();
    GridField<dim>   &field = parts.discretization.field();
    if (!walls.have_friction() || field.mass->is_exact())
      return nullptr;
    return std::make_unique<LumpedWallFriction<dim>>(walls, field);
  }



  template <int dim>
  LumpedWallFriction<dim>::LumpedWallFriction(const Walls<dim> &walls,
                                              GridField<dim>   &field)
    : FrictionWalls<dim>(walls, field)
  {}



  template <int dim>
  void
  LumpedWallFriction<dim>::apply(ContactStep<dim> &step)
  {
    GridField<dim> &field = this->field;
    before                = field.new_velocity;
    add_to<dim>(field.momentum_of_walls,
                this->walls.add_contact(field.new_velocity,
                                        field.acceleration,
                                        step.dt,
                                        field.lumped_mass));
    // The impulses change the kinetic energy.
    const VectorType &lumped      = field.lumped_mass;
    double            work_before = 0., work_after = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
        {
          const double impulse =
            lumped.local_element(i) * (field.new_velocity[d].local_element(i) -
                                       before[d].local_element(i));
          work_before += impulse * field.velocity[d].local_element(i);
          work_after += impulse * field.new_velocity[d].local_element(i);
        }
    step.add_work(work_before, work_after);
  }



  template <int dim>
  std::unique_ptr<Contact<dim>>
  WallFriction<dim>::make(const IntegratorParts<dim> &parts)
  {
    const Walls<dim> &walls = parts.discretization.walls();
    GridField<dim>   &field = parts.discretization.field();
    if (!walls.have_friction() || !field.mass->is_exact())
      return nullptr;
    return std::make_unique<WallFriction<dim>>(walls, field, parts.log);
  }



  template <int dim>
  WallFriction<dim>::WallFriction(const Walls<dim> &walls,
                                  GridField<dim>   &field,
                                  StepLog          &log)
    : FrictionWalls<dim>(walls, field)
    , contact(walls, *field.mass)
    , log(log)
  {}



  template <int dim>
  void
  WallFriction<dim>::apply(ContactStep<dim> &step)
  {
    const PartTimer timer(log, "contact");
    GridField<dim> &field = this->field;
    fail_with([&]() {
      add_to<dim>(field.momentum_of_walls,
                  contact.add(field.new_velocity,
                              field.acceleration,
                              step.dt,
                              step.state.field.slid));
    });
    step.most_iterations =
      std::max(step.most_iterations, contact.most_iterations());
    step.n_iterations += contact.n_iterations();
    step.add_work(contact.work(field.velocity, field.velocity),
                  contact.work(field.new_velocity, field.new_velocity));
  }



  template <int dim>
  void
  WallFriction<dim>::forget()
  {
    contact.forget();
  }



  template class FrictionWalls<2>;
  template class FrictionWalls<3>;
  template class LumpedWallFriction<2>;
  template class LumpedWallFriction<3>;
  template class WallFriction<2>;
  template class WallFriction<3>;
} // namespace greville

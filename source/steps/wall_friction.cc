// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/wall_friction.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::unique_ptr<Contact<dim>>
  WallFriction<dim>::make(const IntegratorParts<dim> &parts)
  {
    const Walls<dim> &walls = parts.discretization.walls();
    if (!walls.have_friction())
      return nullptr;
    return std::make_unique<WallFriction<dim>>(walls,
                                               parts.discretization.field());
  }



  template <int dim>
  WallFriction<dim>::WallFriction(const Walls<dim> &walls,
                                  GridField<dim>   &field)
    : walls(walls)
    , field(field)
  {}



  template <int dim>
  void
  WallFriction<dim>::apply(ContactStep<dim> &step)
  {
    before                    = field.new_velocity;
    const WallSums<dim> given = walls.add_contact(field.new_velocity,
                                                  field.acceleration,
                                                  step.dt,
                                                  field.lumped_mass);
    for (unsigned int w = 0; w < 2 * dim; ++w)
      field.momentum_of_walls[w] += given[w];
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



  GREVILLE_INSTANTIATE_CLASS(WallFriction);
} // namespace greville

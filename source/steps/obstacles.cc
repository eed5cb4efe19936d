// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/obstacles.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Functions of which an obstacle fills less are not its own. Those are the
    // ones that are below 0.1 at its surface.
    constexpr double smallest_share = 1e-3;

    // Relative to the share over the size of a cell, normals are zero below
    // this.
    constexpr double smallest_normal = 0.05;
  } // namespace



  template <int dim>
  std::unique_ptr<Contact<dim>>
  Obstacles<dim>::make(const IntegratorParts<dim> &parts)
  {
    if (rigid_bodies(parts.initial.bodies).empty())
      return nullptr;
    return std::make_unique<Obstacles<dim>>(parts.discretization.space());
  }



  template <int dim>
  Obstacles<dim>::Obstacles(const SplineSpace<dim> &space)
    : space(space)
  {
    space.initialize_vector(volume);
    for (auto *field : {&momentum, &gradient})
      for (VectorType &component : *field)
        space.initialize_vector(component);
    const unsigned int p = space.degree();
    for (const std::uint64_t position : space.owned_functions())
      {
        const auto index    = multi_index<dim>(position, space.n_functions());
        double     integral = 1.;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const auto &knots = space.knots(d).knots();
            integral *= (knots[index[d] + p + 1] - knots[index[d]]) / (p + 1.);
          }
        integrals.push_back(integral);
      }
  }



  template <int dim>
  void
  Obstacles<dim>::begin_step(const ContactStep<dim> &at)
  {
    using Layout         = PointLayout<dim>;
    const unsigned int n = integrals.size();
    step                 = at.end - at.begin;
    share.assign(n, 0.);
    touching.assign(at.fields.size(), std::vector<unsigned char>(n, 0));
    for (unsigned int d = 0; d < dim; ++d)
      normal[d].assign(n, 0.);
    for (auto &field : velocities)
      field.assign(n, Tensor<1, dim>());

    for (const Body<dim> *body : rigid_bodies(at.state.bodies))
      {
        // With the volume for mass and the pressure 1, the force of the points
        // is the sum of V_p grad N_i.
        points                 = body->points;
        const PointField *load = points.layout().find("load");
        points.for_each([&](const unsigned int, PointRef<dim> point) {
          point.mass() = point.volume();
          for (unsigned int k = 0; k < Layout::n_stress; ++k)
            point.stress(k) = k < 3 ? -1. : 0.;
          if (load)
            for (unsigned int d = 0; d < dim; ++d)
              point[load->first + d] = 0.;
        });
        at.transfer.points_to_grid({&points}, &volume, &momentum, &gradient);

        const Tensor<1, dim> v[2] = {(*body->rigid_motion)(at.begin),
                                     (*body->rigid_motion)(at.end)};
        for (unsigned int i = 0; i < n; ++i)
          {
            const double part = volume.local_element(i) / integrals[i];
            share[i] += part;
            for (unsigned int k = 0; k < 2; ++k)
              velocities[k][i] += part * v[k];
            for (unsigned int d = 0; d < dim; ++d)
              normal[d][i] += gradient[d].local_element(i) / integrals[i];
          }
      }
    // At the edge of the grid, where its points end, an obstacle has no
    // surface.
    for (unsigned int i = 0; i < n; ++i)
      {
        const auto index =
          multi_index<dim>(space.owned_functions()[i], space.n_functions());
        for (unsigned int d = 0; d < dim; ++d)
          if (!space.lattice().is_periodic(d) &&
              (index[d] == 0 || index[d] + 1 == space.n_functions()[d]))
            normal[d][i] = 0.;
      }
    for (unsigned int i = 0; i < n; ++i)
      if (share[i] > 0.)
        for (auto &field : velocities)
          field[i] /= share[i];
  }



  template <int dim>
  void
  Obstacles<dim>::touch(GridField<dim>             &field,
                        std::vector<unsigned char> &touching,
                        const ContactStep<dim>     &at) const
  {
    constexpr unsigned char all = (1 << dim) - 1;
    for (unsigned int i = 0; i < integrals.size(); ++i)
      {
        touching[i]    = 0;
        const double m = field.lumped_mass.local_element(i);
        if (share[i] < smallest_share || !(m > 0.))
          continue;
        double impulse = 0., size = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double h = space.lattice().cell_size(d);
            double       f = m * at.gravity[d];
            if (at.knows_force)
              f += field.force[d].local_element(i);
            impulse +=
              normal[d][i] * (m * velocities[1][i][d] -
                              field.momentum[d].local_element(i) - step * f);
            size += std::pow(normal[d][i] * h, 2);
          }
        if (impulse < 0. && std::sqrt(size) > smallest_normal * share[i])
          continue;
        touching[i]                     = all & ~field.mass->held_by_walls(i);
        field.constraints.components[i] = all;
      }
  }



  template <int dim>
  void
  Obstacles<dim>::constrain(ContactStep<dim> &at)
  {
    for (unsigned int k = 0; k < at.fields.size(); ++k)
      {
        GridField<dim> &field = at.fields[k];
        touch(field, touching[k], at);
        if (!at.knows_velocity)
          set_velocity(field.velocity, k, false);
        set_acceleration(field, k);
      }
  }



  template <int dim>
  void
  Obstacles<dim>::apply(ContactStep<dim> &at)
  {
    for (unsigned int k = 0; k < at.fields.size(); ++k)
      {
        set_velocity(at.fields[k].new_velocity, k, true);
        set_acceleration(at.fields[k], k);
      }
  }



  template <int dim>
  void
  Obstacles<dim>::set_velocity(VectorField<dim>  &velocity,
                               const unsigned int field,
                               const bool         at_end) const
  {
    const std::vector<unsigned char> &bits = touching[field];
    for (unsigned int i = 0; i < bits.size(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        if ((bits[i] >> d) & 1)
          velocity[d].local_element(i) = velocities[at_end][i][d];
  }



  template <int dim>
  void
  Obstacles<dim>::set_acceleration(GridField<dim>    &field,
                                   const unsigned int number) const
  {
    const std::vector<unsigned char> &bits = touching[number];
    for (unsigned int i = 0; i < bits.size(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        if ((bits[i] >> d) & 1)
          field.acceleration[d].local_element(i) =
            step > 0.
              ? (velocities[1][i][d] - field.velocity[d].local_element(i)) /
                  step
              : 0.;
  }



  template class Obstacles<2>;
  template class Obstacles<3>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/friction_contact.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Rounds in which a friction that turns asks for another one.
    constexpr unsigned int n_turns = 10;

    // Times that a contact is released, and that it is stopped.
    constexpr unsigned int n_changes = 3;

    // Relative to the largest of their kind, speeds and impulses are zero below
    // this.
    constexpr double negligible = 1e-6;
  } // namespace



  template <int dim>
  FrictionContact<dim>::FrictionContact(const Walls<dim> &walls,
                                        GridMass<dim>    &mass)
    : walls(walls)
    , mass(mass)
    , normals(mass.space().owned_functions().size())
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (walls.is_friction(w))
        for (const unsigned int i : walls.functions(w))
          if (!((mass.held_components(i) >> (w / 2)) & 1))
            {
              Contact contact;
              contact.wall     = w;
              contact.function = i;
              contacts.push_back(contact);
            }
    for (auto *field : {&change, &load, &reaction, &held})
      for (VectorType &component : *field)
        mass.space().initialize_vector(component);
  }



  template <int dim>
  double
  FrictionContact<dim>::speed_into_wall(const Contact          &contact,
                                        const VectorField<dim> &v) const
  {
    // What is held otherwise is no contact.
    if ((mass.held_components(contact.function) >> (contact.wall / 2)) & 1)
      return 0.;
    return (contact.wall % 2 == 0 ? -1. : 1.) *
           v[contact.wall / 2].local_element(contact.function);
  }



  template <int dim>
  Tensor<1, dim>
  FrictionContact<dim>::along_wall(const Contact          &contact,
                                   const VectorField<dim> &v) const
  {
    Tensor<1, dim>      result;
    const unsigned char elsewhere =
      mass.held_components(contact.function) | normals[contact.function];
    for (unsigned int c = 0; c < dim; ++c)
      if (c != contact.wall / 2 && !((elsewhere >> c) & 1))
        result[c] = v[c].local_element(contact.function);
    return result;
  }



  template <int dim>
  void
  FrictionContact<dim>::solve(const VectorField<dim> &velocity)
  {
    std::fill(normals.begin(), normals.end(), 0);
    for (const Contact &contact : contacts)
      if (contact.state != State::apart)
        normals[contact.function] |= 1 << (contact.wall / 2);

    std::vector<unsigned char> held = normals;
    for (VectorType &component : load)
      component = 0.;
    for (const Contact &contact : contacts)
      {
        const unsigned int i      = contact.function;
        const unsigned int normal = contact.wall / 2;
        if (contact.state == State::apart)
          continue;
        change[normal].local_element(i) = -velocity[normal].local_element(i);
        const unsigned char elsewhere   = mass.held_components(i) | normals[i];
        for (unsigned int c = 0; c < dim; ++c)
          if ((elsewhere >> c) & 1)
            continue;
          else if (contact.state == State::slides)
            load[c].local_element(i) += contact.load[c];
          else
            {
              held[i] |= 1 << c;
              change[c].local_element(i) = -velocity[c].local_element(i);
            }
      }
    mass.solve_held(change, load, held);
    mass.reactions(reaction, change);
    iterations += mass.n_iterations();
    most = std::max(most, mass.n_iterations());
    ++rounds;
  }



  template <int dim>
  bool
  FrictionContact<dim>::update(const VectorField<dim> &velocity,
                               const double            smallest_speed)
  {
    const MPI_Comm comm    = mass.space().communicator();
    double         largest = 0.; // impulse
    for (const Contact &contact : contacts)
      if (contact.state != State::apart)
        largest =
          std::max(largest, std::abs(speed_into_wall(contact, reaction)));
    const double smallest = negligible * Utilities::MPI::max(largest, comm);

    bool has_changed = false;
    for (Contact &contact : contacts)
      {
        const double speed =
          speed_into_wall(contact, velocity) + speed_into_wall(contact, change);
        if (contact.state == State::apart)
          {
            if (speed > smallest_speed)
              {
                contact.state = State::sticks;
                has_changed   = true;
              }
            continue;
          }
        const double push = -speed_into_wall(contact, reaction);
        if (push < -smallest && contact.n_released < n_changes)
          {
            contact.state = State::apart;
            ++contact.n_released;
            has_changed = true;
            continue;
          }
        const double bound =
          walls.friction_coefficient(contact.wall) * std::max(push, 0.);
        if (contact.state == State::sticks)
          {
            const Tensor<1, dim> impulse = along_wall(contact, reaction);
            if (impulse.norm() > bound + smallest)
              {
                contact.state = State::slides;
                contact.load  = bound / impulse.norm() * impulse;
                has_changed   = true;
              }
            continue;
          }
        const Tensor<1, dim> v =
          along_wall(contact, velocity) + along_wall(contact, change);
        if (v * contact.load > 0. && contact.n_stopped < n_changes)
          {
            contact.state = State::sticks;
            ++contact.n_stopped;
            has_changed = true;
          }
        else if (v.norm() > 0.)
          {
            const Tensor<1, dim> next = -bound / v.norm() * v;
            has_changed =
              has_changed ||
              ((next - contact.load).norm() > smallest && rounds < n_turns);
            contact.load = next;
          }
      }
    return Utilities::MPI::max<unsigned int>(has_changed, comm) == 1;
  }



  template <int dim>
  WallSums<dim>
  FrictionContact<dim>::impulses()
  {
    WallSums<dim>              sums;
    std::vector<unsigned char> counted = normals;
    for (const Contact &contact : contacts)
      if (contact.state != State::apart)
        {
          const unsigned int i = contact.function, normal = contact.wall / 2;
          for (unsigned int c = 0; c < dim; ++c)
            if (c == normal ||
                !(((counted[i] | mass.held_components(i)) >> c) & 1))
              sums[contact.wall][c] += reaction[c].local_element(i);
          counted[i] |= (1 << dim) - 1;
        }
    // Walls that hold take what the change would give them.
    for (VectorType &component : load)
      component = 0.;
    mass.rows_of_held(held, change, load, 0);
    walls.add_held(sums, [&](const unsigned int c, const unsigned int i) {
      return held[c].local_element(i);
    });
    return sums;
  }



  template <int dim>
  WallSums<dim>
  FrictionContact<dim>::add(VectorField<dim>  &velocity,
                            VectorField<dim>  &acceleration,
                            const double       dt,
                            std::vector<bool> &slid)
  {
    slid.resize(contacts.size(), false);
    iterations = most = rounds = 0;
    double fastest = 0., fastest_into_wall = 0.;
    for (const Contact &contact : contacts)
      {
        fastest_into_wall =
          std::max(fastest_into_wall,
                   std::abs(speed_into_wall(contact, velocity)));
        for (unsigned int c = 0; c < dim; ++c)
          fastest =
            std::max(fastest,
                     std::abs(velocity[c].local_element(contact.function)));
      }
    const MPI_Comm comm = mass.space().communicator();
    const double   smallest_speed =
      std::max(negligible * Utilities::MPI::max(fastest_into_wall, comm),
               1e-14 * Utilities::MPI::max(fastest, comm));

    bool touches = false;
    for (unsigned int k = 0; k < contacts.size(); ++k)
      {
        Contact   &contact = contacts[k];
        const bool is_touched =
          speed_into_wall(contact, velocity) > smallest_speed;
        contact.state      = !is_touched ? State::apart
                             : slid[k]   ? State::slides
                                         : State::sticks;
        contact.n_released = contact.n_stopped = 0;
        touches                                = touches || is_touched;
      }
    for (VectorType &component : reaction)
      component = 0.;
    if (Utilities::MPI::max<unsigned int>(touches, comm) == 0)
      return {};

    for (VectorType &component : change)
      component = 0.;
    do
      solve(velocity);
    while (update(velocity, smallest_speed));
    for (unsigned int k = 0; k < contacts.size(); ++k)
      slid[k] = contacts[k].state == State::slides;

    for (unsigned int c = 0; c < dim; ++c)
      {
        velocity[c] += change[c];
        if (dt > 0.)
          acceleration[c].add(1. / dt, change[c]);
      }
    return impulses();
  }



  template <int dim>
  double
  FrictionContact<dim>::work(const VectorField<dim> &v,
                             const VectorField<dim> &w) const
  {
    double sum = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int i = 0; i < reaction[c].locally_owned_size(); ++i)
        sum += 0.5 * reaction[c].local_element(i) *
               (v[c].local_element(i) + w[c].local_element(i));
    return sum;
  }



  template class FrictionContact<2>;
  template class FrictionContact<3>;
} // namespace greville

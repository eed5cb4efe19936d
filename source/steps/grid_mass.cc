// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/mass/fmpm.h>
#include <greville/steps/consistent_mass.h>
#include <greville/steps/lumped_mass.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  GridMass<dim>::GridMass(const OrderHierarchy<dim> &orders,
                          const Walls<dim>          &walls)
    : orders(orders)
  {
    space().initialize_vector(lumped_mass);
    held      = held_components_at_walls(space(), walls);
    wall_held = held;
  }



  template <int dim>
  void
  GridMass<dim>::hold(const std::vector<unsigned char> &more)
  {
    std::vector<unsigned char> now = with_ghosts(space(), more);
    for (unsigned int f = 0; f < now.size(); ++f)
      now[f] |= wall_held[f];
    const bool has_changed =
      Utilities::MPI::max<unsigned int>(now != held, space().communicator());
    if (!has_changed)
      return;
    held = now;
    change_held();
  }



  template <int dim>
  void
  GridMass<dim>::begin_trial()
  {
    held_before_trial = held;
  }



  template <int dim>
  void
  GridMass<dim>::end_trial()
  {
    const bool has_changed =
      Utilities::MPI::max<unsigned int>(held_before_trial != held,
                                        space().communicator());
    if (!has_changed)
      return;
    held = held_before_trial;
    change_held();
  }



  template <int dim>
  std::array<bool, dim>
  GridMass<dim>::held_meet_mass() const
  {
    std::vector<unsigned int> found(dim, 0);
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      if (held[i] != 0 && lumped_mass.local_element(i) > 0.)
        for (unsigned int c = 0; c < dim; ++c)
          found[c] |= (held[i] >> c) & 1;
    Utilities::MPI::max(found, space().communicator(), found);
    std::array<bool, dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      result[c] = found[c] != 0;
    return result;
  }



  template <int dim>
  void
  GridMass<dim>::held_residual(VectorField<dim>       &residual,
                               const VectorField<dim> &b,
                               const VectorField<dim> &x) const
  {
    const auto meets_mass = held_meet_mass();
    multiply_at_held(residual, x, meets_mass);
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
        {
          const double m = lumped_mass.local_element(i);
          double      &r = residual[c].local_element(i);
          r              = meets_mass[c] && ((held[i] >> c) & 1) && m > 0.
                             ? (b[c].local_element(i) - r) / m
                             : 0.;
        }
  }



  template <int dim>
  std::uint64_t
  GridMass<dim>::n_active() const
  {
    std::uint64_t n = 0;
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      n += lumped_mass.local_element(i) > 0.;
    return Utilities::MPI::sum(n, space().communicator());
  }



  template <int dim>
  std::unique_ptr<GridMass<dim>>
  make_grid_mass(const std::string          &mass,
                 const OrderHierarchy<dim>  &orders,
                 const SimulationParameters &parameters,
                 const Walls<dim>           &walls)
  {
    if (const unsigned int n_terms = n_fmpm_terms(mass))
      return std::make_unique<LumpedMass<dim>>(n_terms, orders, walls);
    Assert(mass == "consistent", ExcMessage("Unknown mass <" + mass + ">."));
    return std::make_unique<ConsistentMass<dim>>(orders, parameters, walls);
  }



  template class GridMass<2>;
  template class GridMass<3>;
  template decltype(make_grid_mass<2>) make_grid_mass<2>;
  template decltype(make_grid_mass<3>) make_grid_mass<3>;
} // namespace greville

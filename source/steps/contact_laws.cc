// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/body_contacts.h>

#include <algorithm>
#include <cmath>
#include <limits>

// The constants and laws of BodyContacts.
namespace greville
{
  using namespace dealii;

  namespace
  {
    // A multiple of the cell size: gaps of touching bodies contain
    // round-off. It must be small compared with the overlaps of stiff bodies:
    // Newton's method stalls at a closed gap without a force.
    constexpr double touching_in_cells = 1e-8;

    // The ratio of tangential to normal stiffness.
    constexpr double shear_share = 0.5;

    // Defaults of ContactParameters::penalty.
    constexpr double implicit_penalty = 10., explicit_penalty = 1.;



    /// Return the plane-strain modulus E / (1 - nu^2), Pa, or the bulk modulus
    /// of a fluid.
    double
    contact_modulus(const Material &material)
    {
      const Moduli moduli = material.moduli();
      if (moduli.shear == 0.)
        return moduli.bulk;
      const double lambda = moduli.bulk - 2. / 3. * moduli.shear;
      return 4. * moduli.shear * (lambda + moduli.shear) /
             (lambda + 2. * moduli.shear);
    }



    double
    impedance(const Material &material)
    {
      const Moduli moduli = material.moduli();
      return std::sqrt(material.density *
                       (moduli.bulk + 4. / 3. * moduli.shear));
    }
  } // namespace



  template <int dim>
  void
  BodyContacts<dim>::make_contact(const SimulationParameters &parameters,
                                  const std::string          &name)
  {
    const ContactParameters &given = parameters.contacts.at(name);
    Contact                  contact;
    contact.name     = name;
    const auto sides = given.sides();

    contact.given     = given;
    contact.impedance = std::numeric_limits<double>::max();

    double       compliance = 0.;
    unsigned int n_sides    = 0;
    for (unsigned int side = 0; side < 2; ++side)
      {
        double modulus = std::numeric_limits<double>::max();
        for (const std::string &body : sides[side])
          for (Simulation<dim> *part : parts)
            {
              auto &surfaces = part->current.surfaces;
              for (unsigned int s = 0; s < surfaces.size(); ++s)
                {
                  const Body<dim> &owner =
                    part->current.bodies[surfaces[s].body];
                  if (surfaces[s].contact != name || owner.name != body)
                    continue;
                  contact.sides[side].push_back({part, s});
                  modulus = std::min(modulus, contact_modulus(*owner.material));
                  contact.impedance =
                    std::min(contact.impedance, impedance(*owner.material));
                }
            }
        if (contact.sides[side].empty())
          continue;
        ++n_sides;
        compliance += 1. / modulus;
      }
    const auto &names = parameters.general.rigid_bodies;
    if (n_sides == 1)
      contact.rigid =
        std::find(names.begin(), names.end(), sides[1][0]) - names.begin();
    contact.modulus = double(n_sides) / compliance;
    take_cells(contact);
    find_smallest(contact);
    set_law(contact);
    contacts.push_back(std::move(contact));
  }



  template <int dim>
  void
  BodyContacts<dim>::set_law(Contact &contact) const
  {
    const double default_penalty =
      are_implicit ? implicit_penalty : explicit_penalty;
    const double penalty =
      contact.given.penalty > 0. ? contact.given.penalty : default_penalty;
    ContactLaw law;
    law.has_two_sides = contact.rigid < 0;
    law.both_measure  = !contact.given.is_by_material_points();
    for (unsigned int side = 0; side < 2; ++side)
      law.has_pores[side] =
        std::any_of(contact.sides[side].begin(),
                    contact.sides[side].end(),
                    [](const Place &place) {
                      return place.part->stage_parameters().general.pore_water;
                    });
    // With a stiffness that depends on the place, overlaps would depend on it,
    // and a uniform pressure would strain the bodies.
    law.stiffness       = penalty * contact.modulus / contact.smallest;
    law.shear_stiffness = shear_share * law.stiffness;
    law.viscosity =
      are_implicit ? 0. : contact.given.damping * contact.impedance;
    law.friction = make_friction_law(contact.given.friction,
                                     "Contact " + contact.name + "/Friction");
    law.adhesion = contact.given.adhesion;
    law.touching = are_implicit ? touching_in_cells * contact.smallest : 0.;
    contact.average =
      std::make_unique<AveragedContact<dim>>(law, contact.lattices, comm);
    // If both sides can move, in opposite directions, the stiffness of each
    // side doubles.
    const bool meets_free =
      contact.rigid >= 0 && rigid_bodies[contact.rigid].is_free();
    const double factor = law.has_two_sides || meets_free ? 2. : 1.;
    for (const auto &side : contact.sides)
      for (const Place &place : side)
        {
          Surface<dim> &surface = place.part->current.surfaces[place.surface];
          surface.stiffness =
            factor * penalty * contact.modulus / contact.cell_size;
          surface.damping = factor * law.viscosity;
        }
  }



  template <int dim>
  bool
  BodyContacts<dim>::take_cells(Contact &contact) const
  {
    std::vector<const Discretization<dim> *>      grids;
    std::vector<std::shared_ptr<const Partition>> cells;
    for (const auto &side : contact.sides)
      for (const Place &place : side)
        {
          const Discretization<dim> &grid = place.part->grid();
          if (std::find(grids.begin(), grids.end(), &grid) != grids.end())
            continue;
          grids.push_back(&grid);
          cells.push_back(grid.partition());
        }
    if (cells.size() == contact.cells.size() &&
        std::equal(cells.begin(),
                   cells.end(),
                   contact.cells.begin(),
                   [](const auto &a, const auto &b) {
                     return a->has_same_cells(*b);
                   }))
      return false;
    contact.cells = cells;
    contact.lattices.clear();
    contact.is_uniform = true;
    contact.cell_size  = 0.;
    for (const Discretization<dim> *grid : grids)
      contact.is_uniform =
        contact.is_uniform && has_equal_cells(grid->space().lattice());
    for (const Discretization<dim> *grid : grids)
      {
        if (contact.is_uniform && grid->cell_size() > contact.cell_size)
          contact.lattices.clear();
        if (!contact.is_uniform || contact.lattices.empty())
          contact.lattices.push_back(grid->space().lattice());
        contact.cell_size = std::max(contact.cell_size, grid->cell_size());
      }
    return true;
  }



  template <int dim>
  bool
  BodyContacts<dim>::find_smallest(Contact &contact) const
  {
    const double last = contact.smallest;
    contact.smallest  = contact.cell_size;
    if (!contact.is_uniform)
      {
        double smallest = std::numeric_limits<double>::max();
        for (unsigned int side = 0; side < 2; ++side)
          for (const Place &place : contact.sides[side])
            {
              const MaterialPoints<dim> &points =
                side == 0 && contact.given.is_by_material_points()
                  ? body_of(place).points
                  : place.part->current.surfaces[place.surface].points;
              for (const unsigned int cell : points.cells())
                {
                  const CellBox<dim> box = points.space().box(cell);
                  smallest               = std::min(smallest,
                                      contact.cell_size_at(points.space(),
                                                           cell,
                                                           box.center));
                }
            }
        smallest = Utilities::MPI::min(smallest, comm);
        if (smallest < std::numeric_limits<double>::max())
          contact.smallest = smallest;
      }
    return contact.smallest != last;
  }



  namespace
  {
    /// Return a text about a point in contact whose hat functions are much
    /// smaller or larger than its cell, empty if there is none. In total
    /// Lagrangian steps, points keep their cells, but hat functions belong to
    /// the cells at their current position.
    template <int dim>
    std::string
    find_other_cells(const BodyContact<dim>    &contact,
                     const MaterialPoints<dim> &points)
    {
      constexpr double   largest_ratio = 2.5, largest_cosine_along = 0.7;
      std::string        text;
      const unsigned int closed = points.layout().first("gap") + 1;
      points.for_each([&](const unsigned int cell, const ConstPointRef<dim> p) {
        if (!text.empty() || p[closed] == 0.)
          return;
        const SurfaceState<dim> at     = surface_state<dim>(p, points.layout());
        const Tensor<1, dim>    normal = at.area_vector();
        const Tensor<1, dim>    own    = points.space().box(cell).size;
        const Lattice<dim>     &lattice =
          contact.lattices[lattice_at(contact.lattices, at.x)];
        const Tensor<1, dim> hats = lattice.box(lattice.find_cell(at.x)).size;
        for (unsigned int d = 0; d < dim && text.empty(); ++d)
          if (std::abs(normal[d]) < largest_cosine_along * normal.norm() &&
              std::max(own[d] / hats[d], hats[d] / own[d]) > largest_ratio)
            text = "a surface point of 'Contact " + contact.name + "' at (" +
                   text_of(at.x) + ") m has the cell size " + text_of(own[d]) +
                   " m, but the grid has " + text_of(hats[d]) +
                   " m there, which determines the averages of contact: "
                   "the pressure is inaccurate. Make these cells equal, "
                   "or take updated Lagrangian steps";
      });
      return text;
    }
  } // namespace



  template <int dim>
  void
  BodyContacts<dim>::set_laws()
  {
    const bool are_new = are_implicit != steps_are_implicit();
    are_implicit       = steps_are_implicit();
    for (Contact &contact : contacts)
      {
        const bool has_new_cells = take_cells(contact);
        if (find_smallest(contact) || has_new_cells || are_new)
          set_law(contact);
        if (contact.is_uniform ||
            !parts.front()->stage_parameters().scheme.is_total_lagrangian())
          continue;
        std::string text;
        for (const auto &side : contact.sides)
          for (const Place &place : side)
            if (text.empty())
              text = find_other_cells(
                contact, place.part->current.surfaces[place.surface].points);
        fail_on_all(text, comm);
      }
  }



  template void
  BodyContacts<2>::make_contact(const SimulationParameters &,
                                const std::string &);
  template void
  BodyContacts<3>::make_contact(const SimulationParameters &,
                                const std::string &);
  template void
  BodyContacts<2>::set_laws();
  template void
  BodyContacts<3>::set_laws();
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/names.h>
#include <greville/parameters/refinement_region.h>
#include <greville/parameters/simulation_parameters.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  RefinementRegion<dim>::RefinementRegion(const RefinementParameters &region,
                                          const std::string          &name,
                                          const bool                  moves,
                                          const IsNearSurface<dim>   &is_near)
    : n_levels(region.levels)
    , distance(region.distance)
    , is_near(is_near)
  {
    if (!region.shape.empty())
      shape.emplace(region.shape, "Refinement " + name + "/Shape", moves);
  }



  template <int dim>
  bool
  RefinementRegion<dim>::contains(const unsigned int  level,
                                  const CellBox<dim> &box,
                                  const double        time) const
  {
    if (!shape && distance == 0.)
      return true;
    // The parts of the box, of this number in each direction.
    const auto part_at = [&](const MultiIndex<dim> &index,
                             const unsigned int     n) {
      CellBox<dim> part = box;
      for (unsigned int d = 0; d < dim; ++d)
        {
          part.size[d]   = box.size[d] / n;
          part.lower[d]  = box.lower[d] + box.size[d] * index[d] / n;
          part.center[d] = box.lower[d] + box.size[d] * (index[d] + 0.5) / n;
        }
      return part;
    };
    const unsigned int n_smallest = 1u
                                    << (n_levels - std::min(level, n_levels));
    if (distance == 0.)
      {
        MultiIndex<dim> extents;
        extents.fill(n_smallest);
        for (unsigned int k = 0; k < Utilities::fixed_power<dim>(n_smallest);
             ++k)
          if (shape->contains(
                part_at(multi_index<dim>(k, extents), n_smallest).center, time))
            return true;
        return false;
      }
    // Search only the parts near surfaces.
    const std::function<bool(const MultiIndex<dim> &, const unsigned int)>
      find = [&](const MultiIndex<dim> &index, const unsigned int n) {
        const CellBox<dim> part = part_at(index, n);
        if (!is_near || !is_near(part, distance))
          return false;
        if (n == n_smallest)
          return !shape || shape->contains(part.center, time);
        for (unsigned int k = 0; k < (1u << dim); ++k)
          {
            MultiIndex<dim> child;
            for (unsigned int d = 0; d < dim; ++d)
              child[d] = 2 * index[d] + (k >> d) % 2;
            if (find(child, 2 * n))
              return true;
          }
        return false;
      };
    return find(MultiIndex<dim>(), 1);
  }



  template <int dim>
  std::shared_ptr<const CellHierarchy<dim>>
  GridParameters::hierarchy(const double              time,
                            const IsNearSurface<dim> &is_near) const
  {
    if (!is_refined())
      return nullptr;
    CellEdges<dim> of_level_0;
    for (unsigned int d = 0; d < dim; ++d)
      {
        of_level_0[d] = edges(d);
        for (unsigned int k = 0; of_level_0[d].size() <= cells[d]; ++k)
          of_level_0[d].push_back(
            k == cells[d] ? upper[d]
                          : lower[d] + (upper[d] - lower[d]) * k / cells[d]);
      }
    std::vector<std::pair<unsigned int, RefinementRegion<dim>>> shapes;
    for (const auto &[name, region] : regions)
      if (!region.has_indicator() && region.acts_at(time))
        shapes.emplace_back(
          region.levels,
          RefinementRegion<dim>(region, name, adapt_every > 0, is_near));
    return std::make_shared<const CellHierarchy<dim>>(
      of_level_0,
      n_levels(),
      degree,
      [shapes, time](const unsigned int level, const CellBox<dim> &box) {
        return std::any_of(shapes.begin(),
                           shapes.end(),
                           [&](const auto &region) {
                             return level < region.first &&
                                    region.second.contains(level, box, time);
                           });
      });
  }



  void
  SimulationParameters::check_refinement() const
  {
    const Refusal refuse{"'Grid/Refinement'"};
    const bool    adapts             = grid.adapt_every > 0;
    const auto    has_plastic_strain = [&]() {
      return std::any_of(
        materials.begin(), materials.end(), [](const auto &material) {
          return contains(material.second->state_names(), "plastic_strain");
        });
    };
    Require((grid.most_cells == 0 && grid.adapt_at_start == 0) ||
              std::any_of(grid.regions.begin(),
                          grid.regions.end(),
                          [](const auto &region) {
                            return region.second.has_indicator();
                          }),
            "The parameters 'Grid/Most cells' and 'Adapt at start' need a "
            "region of 'Grid/Refinement' with an 'Indicator'.");
    for (const auto &[name, region] : grid.regions)
      {
        if (general.dimension == 2)
          RefinementRegion<2>(region, name, adapts);
        else
          RefinementRegion<3>(region, name, adapts);
        const std::string section = "'Refinement " + name + "/";
        Require(!region.shape.empty() || region.distance > 0. ||
                  region.has_indicator(),
                "The parameter " + section +
                  "Shape' is empty: it has to be the formula of a region, "
                  "unless 'Distance to surface' > 0 or an 'Indicator' is "
                  "given.");
        Require(grid.has_changing_cells() || !region.has_indicator(),
                "The parameter " + section +
                  "Indicator' = " + word_of(region.indicator, indicators) +
                  " needs 'Grid/Adapt every' or 'Grid/Adapt at start' > 0.");
        Require(region.indicator == Indicator::plastic_strain ||
                  region.refine_above == RefinementParameters().refine_above,
                "The parameter " + section +
                  "Refine above' needs 'Indicator' = "
                  "plastic strain.");
        Require(region.indicator != Indicator::plastic_strain ||
                  has_plastic_strain(),
                "The parameter " + section +
                  "Indicator' = plastic strain: no material has the variable "
                  "plastic_strain.");
        Require(adapts || (region.from.empty() && region.until.empty()),
                "The parameters " + section +
                  "From' and 'Until' need "
                  "'Grid/Adapt every' > 0.");
        Require(region.from.empty() || region.until.empty() ||
                  region.from[0] < region.until[0],
                "The parameter " + section +
                  "From' = " + text_of(region.from[0]) +
                  " s has to be less than 'Until' = " +
                  text_of(region.until[0]) + " s.");
      }
    constexpr unsigned int largest_order = 3;
    refuse(grid.degree > largest_order,
           "'Grid/Order' = " + std::to_string(grid.degree),
           "take an order up to " + std::to_string(largest_order) + ".");
    refuse(general.pore_water,
           "'Simulation/Pore water' = true",
           "the cells of its pressure are pairs of cells.");
    refuse(has_body_grids(),
           "'Grid/Per body' = true and sections 'Body NAME/Grid'",
           "all bodies use one grid.");
    // Limits of the positions of functions in a direction, and of the number of
    // points at which regions are evaluated.
    constexpr double most_in_direction = 5e5, most_tests = 1e9;
    double           n_tests = 1.;
    for (unsigned int d = 0; d < general.dimension; ++d)
      {
        const double n = std::ldexp(grid.cells[d], grid.n_levels());
        n_tests *= n;
        Require(2. * n < most_in_direction,
                "The parameter 'Levels' of 'Grid/Refinement' makes up to " +
                  text_of(n) + " cells in a direction: take fewer.");
      }
    Require(
      n_tests < most_tests,
      "The parameter 'Levels' of 'Grid/Refinement' divides the grid into "
      "up to " +
        text_of(n_tests) +
        " cells, each of which is looked at: take fewer levels or cells.");
    for (const auto &[name, body] : bodies)
      refuse(!body.shape_file.empty(),
             "'Body " + name + "/Shape file'",
             "take a formula, 'Shape'.");
  }



  void
  SimulationParameters::check_refinement_of_stage() const
  {
    const Refusal refuse{"'Grid/Refinement'"};
    const bool    is_explicit = is_explicit_scheme(scheme.stress_update);
    refuse(!scheme.has_consistent_mass() &&
             !(is_explicit && scheme.has_lumped_mass()),
           "'Scheme/Mass' = " + scheme.mass,
           is_explicit ? "take consistent, or lumped with 'Scheme/Transfer' = "
                         "Taylor."
                       : "take consistent.");
    refuse(
      scheme.has_lumped_mass() && !scheme.has_affine(),
      "'Scheme/Mass' = lumped with 'Scheme/Transfer' = " + scheme.transfer,
      "a linear velocity would change between cells of two sizes. Take "
      "'Scheme/Transfer' = Taylor or APIC, or 'Scheme/Mass' = consistent.");
    refuse(scheme.has_lumped_mass() && grid.degree == 1,
           "'Grid/Order' = 1 with 'Scheme/Mass' = lumped",
           "functions of small cells at surfaces have hardly any mass. Take "
           "order 2 or 3, or 'Scheme/Mass' = consistent.");
    for (const auto &[name, contact] : contacts)
      refuse(
        scheme.has_lumped_mass() &&
          (!contact.is_by_material_points() ||
           rigid_bodies.count(contact.sides()[1][0]) == 0),
        "'Contact " + name + "' with 'Scheme/Mass' = lumped",
        "points of surfaces lie in cells whose functions may have no mass. "
        "Take a rigid body and 'Contactors' = material points, or "
        "'Scheme/Mass' = consistent.");
    if (scheme.is_total_lagrangian())
      {
        for (const auto &group : body_groups())
          refuse(group.size() > 1,
                 "several bodies on one grid with 'Scheme/Formulation' = total "
                 "Lagrangian",
                 "take one body, or bodies that meet in 'Contacts'.");
        refuse(grid.adapt_at_start > 0 && bodies.size() > 1,
               "'Grid/Adapt at start' of several bodies with "
               "'Scheme/Formulation' = total Lagrangian",
               "take 'Grid/Adapt every'.");
      }
    refuse(scheme.averages_over_domains(),
           "'Scheme/Functions' = domains",
           "take points.");
    refuse(scheme.has_projection(),
           "'Scheme/Volumetric projection' = " + scheme.volumetric_projection,
           "take none.");
    for (unsigned int w = 0; w < 2 * general.dimension; ++w)
      for (const std::string type : {"periodic", "friction"})
        refuse(walls.type[w] == type,
               "'Walls/" + WallParameters::names[w] + "' = " + type,
               "take another type.");
    if (is_explicit)
      refuse(solver.has_cycle(),
             "'Solver/Preconditioner' = p-multigrid",
             "take auto.");
    else
      {
        refuse(!implicit_solver.multigrid.coarsens_lattices(),
               "'Implicit solver/Levels' = orders",
               "take lattice.");
      }
  }



  GREVILLE_INSTANTIATE_CLASS(RefinementRegion);
  template std::shared_ptr<const CellHierarchy<2>>
  GridParameters::hierarchy<2>(const double, const IsNearSurface<2> &) const;
  template std::shared_ptr<const CellHierarchy<3>>
  GridParameters::hierarchy<3>(const double, const IsNearSurface<3> &) const;
} // namespace greville

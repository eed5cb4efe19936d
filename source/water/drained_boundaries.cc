// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/parameters/names.h>
#include <greville/water/drained_boundaries.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  WaterConstants
  water_constants(const Body<dim> &body, const WaterParameters &water)
  {
    const Material &material = *body.material;
    return {water.bulk_modulus > 0. ? material.porosity / water.bulk_modulus
                                    : 0.,
            material.conductivity / water.unit_weight(),
            material.has_kozeny_carman ? 1. - material.porosity : 0.,
            water.suction()};
  }



  template <int dim>
  DrainedBoundaries<dim>::DrainedBoundaries(
    const SplineSpace<dim>     &displacements,
    const SimulationParameters &parameters,
    const double                penalty)
    : displacements(displacements)
    , parameters(parameters)
    , penalty(penalty)
  {
    const auto given = [](const std::string              &pressure,
                          const bool                      is_seepage_face,
                          const std::string              &flux,
                          const std::string              &pressure_name,
                          const std::string              &flux_name,
                          const std::vector<std::string> &variables) -> Given {
      if (!flux.empty())
        return {{flux, flux_name, variables}, Kind::flux};
      return {{pressure, pressure_name, variables},
              is_seepage_face ? Kind::seepage : Kind::pressure};
    };
    const WallParameters &walls = parameters.walls;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (walls.passes_water(w))
        {
          const std::string name = "Walls/" + WallParameters::names[w];
          of_walls.emplace(w,
                           given(walls.pore_pressure[w],
                                 walls.seepage_face[w],
                                 walls.flux[w],
                                 name + " pore pressure",
                                 name + " flux",
                                 variables_of<dim>("xt")));
        }
    const auto &names = parameters.general.surface_loads;
    for (unsigned int k = 0; k < names.size(); ++k)
      {
        const SurfaceLoadParameters &load =
          parameters.surface_loads.at(names[k]);
        const std::string name = "Surface load " + names[k];
        if (load.passes_water())
          of_surfaces.emplace(k,
                              given(load.pore_pressure,
                                    load.seepage_face,
                                    load.flux,
                                    name + "/Pore pressure",
                                    name + "/Flux",
                                    variables_of<dim>("xXt")));
      }
  }



  template <int dim>
  bool
  DrainedBoundaries<dim>::has_seepage_face() const
  {
    for (const auto *given : {&of_walls, &of_surfaces})
      for (const auto &entry : *given)
        if (entry.second.kind == Kind::seepage)
          return true;
    return false;
  }



  template <int dim>
  void
  DrainedBoundaries<dim>::set(DrainedPoint                  &point,
                              const Given                   &given,
                              const ArrayView<const double> &arguments) const
  {
    point.kind  = given.kind;
    point.value = given.formula(arguments);
    if (given.kind == Kind::flux)
      return;
    // Below a water level, water flows in, too.
    if (point.value > 0.)
      point.kind = Kind::pressure;
    point.mobility *=
      relative_conductivity(point.value, parameters.water.suction())[0];
  }



  template <int dim>
  bool
  DrainedBoundaries<dim>::set_soil(DrainedPoint                 &point,
                                   const std::vector<Body<dim>> &bodies,
                                   const unsigned int            cell) const
  {
    double volume = 0., volume0 = 0., mobility = 0., solid = 0.;
    for (const Body<dim> &body : bodies)
      {
        const WaterConstants soil = water_constants(body, parameters.water);
        body.points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
          volume += p.volume();
          volume0 += p.volume0();
          mobility += p.volume() * soil.mobility;
          solid += p.volume() * soil.solid;
        });
      }
    if (volume == 0.)
      return false;
    point.mobility = mobility / volume;
    point.solid    = solid / volume;
    point.old_J    = volume / volume0;
    return true;
  }



  template <int dim>
  void
  DrainedBoundaries<dim>::add_walls(const std::vector<Body<dim>> &bodies,
                                    const std::vector<double>    &filled,
                                    const double                  time,
                                    WaterPoints<dim>             &points) const
  {
    const QGauss<dim - 1>       gauss(displacements.degree() + 1);
    std::array<double, dim + 1> arguments;
    arguments[dim] = time;
    for (const auto &[w, given] : of_walls)
      {
        const unsigned int d    = w / 2;
        const unsigned int side = w % 2;
        const unsigned int end =
          side == 0 ? 0 : displacements.cells_per_direction()[d] - 1;
        for (unsigned int c = 0; c < displacements.owned_cells().size(); ++c)
          {
            const CellBox<dim> box = displacements.box(c);
            if (box.index[d] != end)
              continue;
            DrainedPoint of_cell;
            if (!set_soil(of_cell, bodies, c))
              continue;
            const double area = box.volume() / box.size[d];
            for (unsigned int q = 0; q < gauss.size(); ++q)
              {
                DrainedPoint point = of_cell;
                point.cell         = c;
                point.boundary     = w;
                for (unsigned int e = 0, k = 0; e < dim; ++e)
                  point.x[e] =
                    e == d ? (side == 0 ? displacements.lower_corner()[d]
                                        : displacements.upper_corner()[d])
                           : box.lower[e] + box.size[e] * gauss.point(q)[k++];
                point.area[d] = (side == 0 ? -1. : 1.) * area *
                                gauss.weight(q) * std::min(1., filled[c]);
                point.to_basis = unit_symmetric_tensor<dim>();
                if (parameters.grid.is_axisymmetric())
                  {
                    point.radius = point.x[0];
                    point.area *= point.radius;
                  }
                point.penalty = penalty / (2. * box.size[d]);
                for (unsigned int e = 0; e < dim; ++e)
                  arguments[e] = point.x[e];
                set(point, given, arguments);
                points.add(point);
              }
          }
      }
  }



  template <int dim>
  void
  DrainedBoundaries<dim>::add_surfaces(
    const std::vector<Body<dim>>    &bodies,
    const std::vector<Surface<dim>> &all_surfaces,
    const double                     time,
    WaterPoints<dim>                &points) const
  {
    for (const auto &of_surface : of_surfaces)
      {
        const Given            &given   = of_surface.second;
        const Surface<dim>     &surface = all_surfaces[of_surface.first];
        const PointLayout<dim> &layout  = surface.points.layout();
        const WaterConstants    soil =
          water_constants(bodies[surface.body], parameters.water);
        for (const unsigned int cell : surface.points.cells())
          {
            const Tensor<1, dim> h = displacements.box(cell).size;
            surface.points.for_each_in_cell(
              cell, [&](const ConstPointRef<dim> p) {
                const SurfaceState<dim> state = surface_state<dim>(p, layout);
                DrainedPoint            point;
                point.cell     = cell;
                point.boundary = 2 * dim + of_surface.first;
                point.x        = p.basis_position(layout);
                point.area     = p.mass() * state.area_vector();
                point.to_basis = unit_symmetric_tensor<dim>();
                if (layout.is_total_lagrangian())
                  point.to_basis = invert(state.F);
                point.mobility = soil.mobility;
                point.solid    = soil.solid;
                point.old_J    = determinant(state.F);
                if (parameters.grid.is_axisymmetric())
                  {
                    point.radius = state.x[0];
                    point.old_J *= state.x[0] / state.X[0];
                  }
                // The cell size along the normal, which has the direction F^T
                // area in the configuration of the basis functions.
                Tensor<1, dim> normal = point.area;
                if (layout.is_total_lagrangian())
                  normal = transpose(state.F) * point.area;
                double size = 0.;
                for (unsigned int d = 0; d < dim; ++d)
                  size += std::abs(normal[d]) / (2. * h[d]);
                point.penalty =
                  penalty * size * point.area.norm() / normal.norm_square();
                set(point, given, arguments_of(state.x, state.X, time));
                points.add(point);
              });
          }
      }
  }



  GREVILLE_INSTANTIATE(water_constants);
  GREVILLE_INSTANTIATE_CLASS(DrainedBoundaries);
} // namespace greville

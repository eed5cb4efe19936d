// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/pores.h>
#include <greville/steps/body_grids.h>
#include <greville/steps/stage_bodies.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// The lattice of a body's grid before it is cut, and the body's cells in
    /// it.
    template <int dim>
    struct BodyOnGrid
    {
      Lattice<dim> lattice;
      /// The range [first, end) of cells contains all points.
      MultiIndex<dim> first, end;

      void
      join(const BodyOnGrid &other)
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            first[d] = std::min(first[d], other.first[d]);
            end[d]   = std::max(end[d], other.end[d]);
          }
      }
    };



    template <int dim>
    BodyOnGrid<dim>
    place_body(const SimulationParameters &parameters,
               const std::string          &name,
               const GridParameters       &grid,
               const MPI_Comm              comm)
    {
      DistributedTriangulation<dim> mesh(comm,
                                         Triangulation<dim>::none,
                                         mesh_settings<dim>);
      // Grids are cut along cells of level 0.
      GridParameters without_levels = grid;
      without_levels.regions.clear();
      without_levels.marked_at_start.clear();
      const MultiIndex<dim> n_cells =
        create_grid_mesh(mesh,
                         without_levels,
                         parameters.walls,
                         "Body " + name + "/Grid/Cells",
                         parameters.time.start);
      const SplineSpace<dim> space(mesh, 1);
      Body<dim>              body = make_body<dim>(name, parameters);
      make_points(body,
                  space,
                  Loads<dim>(parameters).gravity(parameters.time.start),
                  PointLayout<dim>(body.material->state_names()));

      BodyOnGrid<dim> result;
      result.lattice = space.lattice();
      result.first   = n_cells;
      result.end.fill(0);
      for (const unsigned int cell : body.points.cells())
        {
          const MultiIndex<dim> index = space.box(cell).index;
          for (unsigned int d = 0; d < dim; ++d)
            {
              result.first[d] = std::min(result.first[d], index[d]);
              result.end[d]   = std::max(result.end[d], index[d] + 1);
            }
        }
      for (unsigned int d = 0; d < dim; ++d)
        {
          result.first[d] = Utilities::MPI::min(result.first[d], comm);
          result.end[d]   = Utilities::MPI::max(result.end[d], comm);
        }
      return result;
    }



    /// The range of cells of a part in one direction. extend() adds @p margin
    /// cells on each side. If the grid has enough cells, it adds more until
    /// their number is a multiple of @p multiple.
    struct Range
    {
      unsigned int first, end;

      void
      extend(const unsigned int margin,
             const unsigned int multiple,
             const unsigned int n_cells)
      {
        first = first > margin ? first - margin : 0;
        end   = std::min(end + margin, n_cells);
        while ((end - first) % multiple != 0 && end < n_cells)
          ++end;
        while ((end - first) % multiple != 0 && first > 0)
          --first;
      }
    };



    /// Make wall w of the part free in all stages.
    void
    set_free(SimulationParameters &part, const unsigned int w)
    {
      const auto free = [w](WallParameters &walls) {
        walls.type[w]     = "free";
        walls.region[w]   = "";
        walls.velocity[w] = walls.displacement[w] = "";
        walls.friction[w]                         = 0.;
        walls.pore_pressure[w] = walls.flux[w] = "";
        walls.seepage_face[w]                  = false;
      };
      free(part.walls);
      for (StageParameters &stage : part.stages)
        free(stage.walls);
    }



    /// Return a power of two. If the numbers of cells are multiples of it, each
    /// process stores a small mesh, see create_box_mesh().
    unsigned int
    common_factor(const unsigned int fewest_cells)
    {
      unsigned int factor = 1;
      while (16 * factor <= fewest_cells)
        factor *= 2;
      return factor;
    }



    /// Return a common divisor of all numbers of cells: cells of the pore
    /// pressure are twice as large.
    unsigned int
    smallest_factor(const SimulationParameters &part)
    {
      return part.general.pore_water ? 2 : 1;
    }



    /// Cut the part around the body out of the @p grid, and free its walls that
    /// are not walls of the whole grid.
    template <int dim>
    void
    cut_out(SimulationParameters  &part,
            const BodyOnGrid<dim> &body,
            const GridParameters  &grid)
    {
      const GridParameters whole = part.grid;
      part.grid                  = grid;
      unsigned int thinnest      = std::numeric_limits<unsigned int>::max();
      for (unsigned int d = 0; d < dim; ++d)
        thinnest = std::min(thinnest, body.end[d] - body.first[d]);
      const unsigned int multiple =
        std::max(common_factor(thinnest), smallest_factor(part));
      for (unsigned int d = 0; d < dim; ++d)
        {
          Range range{body.first[d], body.end[d]};
          if (body.lattice.is_periodic(d))
            range = {0, grid.cells[d]};
          range.extend(grid.degree, multiple, grid.cells[d]);
          if (range.first > 0)
            part.grid.lower[d] = body.lattice.edge(d, range.first);
          if (range.end < grid.cells[d])
            part.grid.upper[d] = body.lattice.edge(d, range.end);
          part.grid.cells[d]              = range.end - range.first;
          const std::vector<double> edges = grid.edges(d);
          if (!edges.empty())
            part.grid.set_edges(d,
                                {edges.begin() + range.first,
                                 edges.begin() + range.end + 1});

          const double tolerance = 1e-10 * (whole.upper[d] - whole.lower[d]);
          const bool   is_at_wall[2] = {
              std::abs(part.grid.lower[d] - whole.lower[d]) <= tolerance,
              std::abs(part.grid.upper[d] - whole.upper[d]) <= tolerance};
          for (unsigned int side = 0; side < 2; ++side)
            if (!is_at_wall[side])
              set_free(part, 2 * d + side);
        }
    }
  } // namespace



  bool
  SimulationParameters::has_body_grids() const
  {
    return grid.per_body ||
           std::any_of(body_grids.begin(), body_grids.end(), [](auto &own) {
             return own.second.is_given();
           });
  }



  GridParameters
  SimulationParameters::grid_of(const std::string &body) const
  {
    GridParameters result = grid;
    const auto     own    = body_grids.find(body);
    if (own == body_grids.end())
      return result;
    // A body grid with its own number of cells has cells of equal size.
    if (!own->second.cells.empty())
      result.knots = {};
    if (!own->second.lower.empty())
      result.lower = own->second.lower;
    if (!own->second.upper.empty())
      result.upper = own->second.upper;
    if (!own->second.cells.empty())
      result.cells = own->second.cells;
    if (own->second.degree > 0)
      result.degree = own->second.degree;
    return result;
  }



  void
  SimulationParameters::check_body_grids() const
  {
    const unsigned int dim      = general.dimension;
    const auto         is_alone = [&](const std::string &name) {
      for (const auto &group : body_groups())
        if (group == std::vector<std::string>{name})
          return !contacts.empty();
      return false;
    };
    for (const auto &[name, own] : body_grids)
      {
        const std::string section = "Body " + name + "/Grid";
        Require(scheme.is_total_lagrangian() || !own.is_given() ||
                  is_alone(name),
                "There is a section '" + section +
                  "', but 'Scheme/Formulation' is " + scheme.formulation +
                  ": in updated Lagrangian steps, bodies that contacts name "
                  "have grids of their own; all others meet on one grid.");
        const auto needs = [&](const std::size_t  size,
                               const std::string &entry) {
          Require(size == 0 || size == dim,
                  "The parameter '" + section + "/" + entry + "' takes " +
                    std::to_string(dim) + " numbers in " + std::to_string(dim) +
                    "D, or none, not " + std::to_string(size) + ".");
        };
        needs(own.lower.size(), "Lower corner");
        needs(own.upper.size(), "Upper corner");
        needs(own.cells.size(), "Cells");
        Require(!own.cells.empty() || (own.lower.empty() && own.upper.empty()),
                "'" + section + "' has a corner and no 'Cells': give both.");
        const GridParameters whole = grid_of(name);
        for (unsigned int d = 0; d < dim; ++d)
          {
            Require(whole.lower[d] < whole.upper[d],
                    "'" + section +
                      "/Upper corner' has to be larger than 'Lower corner' in "
                      "all directions, but " +
                      text_of(whole.upper[d]) + " is not above " +
                      text_of(whole.lower[d]) + ".");
            if (!walls.is_periodic(2 * d))
              continue;
            Require(whole.lower[d] == grid.lower[d] &&
                      whole.upper[d] == grid.upper[d],
                    "'" + section + "' ends at " + text_of(whole.lower[d]) +
                      " and " + text_of(whole.upper[d]) +
                      " m between periodic walls at " + text_of(grid.lower[d]) +
                      " and " + text_of(grid.upper[d]) +
                      " m: there, all grids reach from wall to wall.");
            Require(whole.cells[d] > whole.degree,
                    "'" + section + "' has " + std::to_string(whole.cells[d]) +
                      " cells between periodic walls: B-splines of order " +
                      std::to_string(whole.degree) + " need " +
                      std::to_string(whole.degree + 1) +
                      " or more, so that none overlaps itself.");
          }
      }
    Require(
      scheme.is_total_lagrangian() || !grid.per_body,
      "'Grid/Per body' = true does not support 'Scheme/Formulation' = " +
        scheme.formulation +
        ": only total Lagrangian steps give bodies their own grids. In updated "
        "Lagrangian steps bodies share one grid, or meet in 'Contacts'.");
  }



  std::vector<std::vector<std::string>>
  SimulationParameters::body_groups() const
  {
    // The group of each body that is in a contact or has its own grid.
    std::map<std::string, unsigned int> group_of;
    unsigned int                        n_groups = 1; // 0: all others
    const auto join = [&](const std::vector<std::string> &names) {
      const unsigned int group = n_groups++;
      for (const std::string &name : names)
        {
          const unsigned int before = group_of[name];
          group_of[name]            = group;
          for (auto &other : group_of)
            if (before > 0 && other.second == before)
              other.second = group;
        }
    };
    for (const std::string &name : general.contacts)
      for (const auto &side : contacts.at(name).sides())
        if (!side.empty() && rigid_bodies.count(side[0]) == 0)
          join(side);
    for (const std::string &name : general.bodies)
      if (has_body_grids() && group_of[name] == 0)
        join({name});

    std::vector<std::vector<std::string>> result;
    std::map<unsigned int, std::size_t>   place;
    for (const std::string &name : general.bodies)
      {
        const unsigned int group = group_of[name];
        const auto         where = place.emplace(group, result.size());
        if (where.second)
          result.emplace_back();
        result[where.first->second].push_back(name);
      }
    return result;
  }



  template <int dim>
  std::vector<SimulationParameters>
  split_by_grids(const SimulationParameters &parameters, const MPI_Comm comm)
  {
    if (!parameters.has_body_grids() && parameters.contacts.empty())
      return {parameters};
    std::vector<SimulationParameters> parts;
    for (const std::vector<std::string> &group : parameters.body_groups())
      {
        SimulationParameters part = parameters;
        part.general.bodies       = group;
        if (part.general.pore_water && !has_pores(parameters, group))
          {
            part.general.pore_water = false;
            part.water              = WaterParameters();
          }
        const GridParameters grid = parameters.grid_of(group[0]);
        if (parameters.scheme.is_total_lagrangian())
          {
            BodyOnGrid<dim> place =
              place_body<dim>(parameters, group[0], grid, comm);
            for (const std::string &name : group)
              place.join(place_body<dim>(parameters, name, grid, comm));
            cut_out(part, place, grid);
          }
        else
          part.grid = grid;
        part.grid.per_body = false;
        part.body_grids.clear();

        auto &loads = part.general.surface_loads;
        loads.erase(std::remove_if(loads.begin(),
                                   loads.end(),
                                   [&](const std::string &load) {
                                     return !contains(
                                       group,
                                       parameters.surface_loads.at(load).body);
                                   }),
                    loads.end());
        parts.push_back(part);
      }
    return parts;
  }



  GREVILLE_INSTANTIATE(split_by_grids);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/numerics/rtree.h>

#include <greville/contact/rigid_body.h>
#include <greville/spline/cell_neighbors.h>
#include <greville/steps/body_surfaces.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Cells that the points of a body fill less belong to its surface, in a run
    // and at the start.
    constexpr double filled_in_run = 0.5, filled_at_start = 0.99;



    /// Return whether the points of a body fill cells exactly.
    template <int dim>
    bool
    fills_cells(const Body<dim> &body)
    {
      return body.parameters->points_file.empty() &&
             body.parameters->displacement.empty();
    }



    template <int dim>
    BoundingBox<dim>
    bounding_box(const CellBox<dim> &box, const double margin)
    {
      std::pair<Point<dim>, Point<dim>> corners;
      for (unsigned int d = 0; d < dim; ++d)
        {
          corners.first[d]  = box.lower[d] - margin;
          corners.second[d] = box.lower[d] + box.size[d] + margin;
        }
      return BoundingBox<dim>(corners);
    }



    template <int dim>
    double
    distance_between(const BoundingBox<dim> &a, const BoundingBox<dim> &b)
    {
      double square = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        square += Utilities::fixed_power<2>(
          std::max({0.,
                    a.lower_bound(d) - b.upper_bound(d),
                    b.lower_bound(d) - a.upper_bound(d)}));
      return std::sqrt(square);
    }



    /// The cells of surfaces of bodies, and the surfaces of rigid bodies.
    template <int dim>
    class Surfaces
    {
    public:
      /// Collective.
      void
      add(const Body<dim>          &body,
          const SplineSpace<dim>   &space,
          const CellNeighbors<dim> &neighbors,
          const bool                is_new)
      {
        // The parts of owned cells and of their neighbors that points fill.
        std::vector<double> parts(neighbors.positions().size(), 0.);
        for (const unsigned int cell : body.points.cells())
          {
            double volume = 0.;
            body.points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
              volume += body.points.layout().is_total_lagrangian() ? p.volume0()
                                                                   : p.volume();
            });
            parts[cell] =
              volume / cell_volume(space, cell, body.points.layout());
          }
        neighbors.exchange(parts);
        const double full =
          is_new && fills_cells(body) ? filled_at_start : filled_in_run;
        std::vector<std::uint64_t> cells;
        run_on_all(space.communicator(), [&]() {
          for (const unsigned int cell : body.points.cells())
            if (parts[cell] > 0. &&
                (parts[cell] < full ||
                 has_empty_neighbor(space, cell, neighbors, parts)))
              cells.push_back(neighbors.positions()[cell]);
        });
        const CellHierarchy<dim> &levels = *space.lattice().hierarchy();
        for (const auto &of_process :
             Utilities::MPI::all_gather(space.communicator(), cells))
          for (const std::uint64_t p : of_process)
            boxes.push_back(
              bounding_box(space.lattice().box(levels.index(p)), 0.));
      }

      void
      add(const std::string         &name,
          const RigidBodyParameters &parameters,
          const RigidPosition<dim>  *position,
          const double               start)
      {
        // The mass of a free body, which is expensive, does not matter.
        RigidBodyParameters of_surface = parameters;
        of_surface.is_free             = false;
        rigid_bodies.emplace_back(name, of_surface);
        positions.push_back(
          position ? *position : rigid_bodies.back().position_at_start(start));
      }

      void
      finish()
      {
        tree = pack_rtree(boxes);
      }

      bool
      is_near(const CellBox<dim> &box, const double distance) const
      {
        namespace bgi               = boost::geometry::index;
        const BoundingBox<dim> own  = bounding_box(box, 0.);
        const auto             near = [&](const BoundingBox<dim> &other) {
          return distance_between(own, other) < distance;
        };
        if (tree.qbegin(bgi::intersects(bounding_box(box, distance)) &&
                        bgi::satisfies(near)) != tree.qend())
          return true;
        const double within = distance + 0.5 * box.size.norm();
        std::vector<ContactPoint<dim>> center(1);
        center[0].x = box.center;
        for (unsigned int k = 0; k < rigid_bodies.size(); ++k)
          {
            rigid_bodies[k].find_gaps(center,
                                      within,
                                      positions[k],
                                      positions[k]);
            if (std::abs(center[0].distance) < within)
              return true;
          }
        return false;
      }

    private:
      /// Return whether one of the cells across the faces of an owned cell is
      /// empty. They may be half as large.
      static bool
      has_empty_neighbor(const SplineSpace<dim>    &space,
                         const unsigned int         cell,
                         const CellNeighbors<dim>  &neighbors,
                         const std::vector<double> &parts)
      {
        const CellHierarchy<dim> &levels = *space.lattice().hierarchy();
        const CellBox<dim>        box    = space.box(cell);
        // Probes lie outside by this part of the cell, in the middle of each of
        // the neighbors that a face can have.
        constexpr double outside = 1e-3;
        for (unsigned int d = 0; d < dim; ++d)
          for (const int side : {-1, 1})
            for (unsigned int k = 0; k < (1u << (dim - 1)); ++k)
              {
                Point<dim> x = box.center;
                x[d] += side * (0.5 + outside) * box.size[d];
                for (unsigned int e = 0, t = k; e < dim; ++e)
                  if (e != d)
                    {
                      x[e] += (t % 2 == 0 ? -0.25 : 0.25) * box.size[e];
                      t /= 2;
                    }
                if (x[d] < space.lower_corner()[d] ||
                    x[d] > space.upper_corner()[d])
                  continue;
                const unsigned int neighbor = neighbors.find(
                  lexicographic<dim>(levels.find(x),
                                     space.cells_per_direction()));
                AssertThrow(neighbor != numbers::invalid_unsigned_int,
                            ExcInternalError());
                if (parts[neighbor] == 0.)
                  return true;
              }
        return false;
      }

      std::vector<BoundingBox<dim>>   boxes;
      RTree<BoundingBox<dim>>         tree;
      std::vector<RigidBody<dim>>     rigid_bodies;
      std::vector<RigidPosition<dim>> positions;
    };
  } // namespace



  template <int dim>
  IsNearSurface<dim>
  find_surfaces(const SimulationParameters             &parameters,
                const SplineSpace<dim>                 &space,
                const std::vector<Body<dim>>           &bodies,
                const std::vector<RigidBodyState<dim>> &rigid_bodies,
                const bool                              are_new)
  {
    if (!parameters.grid.has_distances())
      return {};
    const auto         surfaces = std::make_shared<Surfaces<dim>>();
    CellNeighbors<dim> neighbors;
    neighbors.reinit(space);
    for (const Body<dim> &body : bodies)
      surfaces->add(body, space, neighbors, are_new);
    const auto &names = parameters.general.rigid_bodies;
    for (unsigned int k = 0; k < names.size(); ++k)
      surfaces->add(names[k],
                    parameters.rigid_bodies.at(names[k]),
                    rigid_bodies.empty() ? nullptr : &rigid_bodies[k].now,
                    parameters.time.start);
    surfaces->finish();
    return [surfaces](const CellBox<dim> &box, const double distance) {
      return surfaces->is_near(box, distance);
    };
  }



  GREVILLE_INSTANTIATE(find_surfaces);
} // namespace greville

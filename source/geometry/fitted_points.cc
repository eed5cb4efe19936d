// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/geometry/compressed_quadrature.h>
#include <greville/geometry/fitted_points.h>
#include <greville/geometry/surface_shape.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Parts of a cell below this fraction have no points. Larger parts must not
    // extend beyond the grid.
    constexpr double smallest_part = 1e-10;

    // Ids are stored as doubles.
    constexpr std::uint64_t largest_id = std::uint64_t(1) << 53;

    // The largest number of surface points per cell.
    constexpr std::uint64_t surface_ids = 1 << 16;



    template <int dim>
    unsigned int
    largest_of(const MultiIndex<dim> &extents)
    {
      return *std::max_element(extents.begin(), extents.end());
    }



    template <int dim>
    void
    check_ids(const SplineSpace<dim> &space,
              const std::uint64_t     n_per_cell,
              const std::string      &section)
    {
      double n_cells = 1.;
      for (const unsigned int n : space.cells_per_direction())
        n_cells *= n;
      Require(n_cells * n_per_cell < largest_id,
              "The grid has too many cells to number the points of '" +
                section + "': make 'Points per direction' smaller.");
    }



    /// Throw if a cell next to the grid contains a part of the shape.
    template <int dim>
    void
    check_walls(const FittedShape<dim> &shape,
                const SplineSpace<dim> &space,
                const CellBox<dim>     &box,
                const std::string      &section)
    {
      for (unsigned int d = 0; d < dim; ++d)
        for (const int side : {-1, 1})
          if (space.is_at_side(box.index[d], 2 * d + (side > 0)))
            {
              // Unsigned indices wrap around: 0 - 1 is the largest number.
              CellBox<dim> outside = box;
              outside.index[d] += side;
              outside.lower[d] += side * box.size[d];
              outside.center[d] += side * box.size[d];
              const CellPart<dim> part   = shape.cut(outside, 1);
              double              volume = part.is_full ? 1. : 0.;
              for (const auto &point : part.points)
                volume += point.weight;
              Point<dim> x = box.center;
              for (unsigned int e = 0; e < dim; ++e)
                if (!part.points.empty())
                  x[e] += box.size[e] *
                          (part.points[0].x[e] - 0.5 + (e == d ? side : 0));
                else if (e == d)
                  x[e] += box.size[e] * side;
              Require(volume < smallest_part,
                      "The body of '" + section +
                        "' sticks out of the grid, for instance at (" +
                        text_of(x) +
                        ") m. Make the grid larger ('Grid/Lower corner', "
                        "'Grid/Upper corner'), the shape smaller, or set 'Clip "
                        "at the grid' to true.");
            }
    }



    template <int dim>
    std::vector<WeightedPoint<dim>>
    whole_cell(const MultiIndex<dim> &extents, const bool has_lattice)
    {
      std::vector<QGauss<1>> quadratures;
      unsigned int           n_points = 1;
      for (const unsigned int n : extents)
        {
          quadratures.emplace_back(n);
          n_points *= n;
        }
      std::vector<WeightedPoint<dim>> result;
      for (unsigned int k = 0; k < n_points; ++k)
        {
          const auto         local = multi_index<dim>(k, extents);
          WeightedPoint<dim> point = {Point<dim>(), 1.};
          for (unsigned int d = 0; d < dim; ++d)
            {
              point.x[d] = has_lattice ? (local[d] + 0.5) / extents[d]
                                       : quadratures[d].point(local[d])[0];
              point.weight *=
                has_lattice ? 1. / extents[d] : quadratures[d].weight(local[d]);
            }
          result.push_back(point);
        }
      return result;
    }



    /// Throw if the unit of a file is implausible.
    template <int dim>
    void
    check_size(const ClosedSurface<dim> &surface,
               const PointPlacement     &placement,
               const std::string        &section,
               const SplineSpace<dim>   &space)
    {
      BoundingBox<dim> box(surface[0]);
      for (const auto &facet : surface)
        box.merge_with(BoundingBox<dim>(facet));
      const auto &[lower, upper] = box.get_boundary_points();
      double in_cells = 0., in_grids = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const double size = upper[d] - lower[d];
          in_cells          = std::max(in_cells, size / space.cell_size(d));
          in_grids          = std::max(in_grids,
                              size / (space.upper_corner()[d] -
                                      space.lower_corner()[d]));
        }
      Require(
        in_cells > 1. && in_grids < 10.,
        "The body in <" + placement.shape_file + "> of the parameter '" +
          section + "/Shape file' reaches from (" + text_of(lower) + ") to (" +
          text_of(upper) + ") m: it is " +
          (in_cells > 1. ? "far larger than the grid" : "smaller than a cell") +
          ". Is 'Unit of shape file' = " + text_of(placement.shape_file_unit) +
          " m right (0.001 for mm)?");
    }



    template <int dim>
    Point<dim>
    point_of_cell(const Point<dim> &xi, const CellBox<dim> &box)
    {
      Point<dim> x = box.lower;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] += std::min(std::max(xi[d], 1e-9), 1. - 1e-9) * box.size[d];
      return x;
    }
  } // namespace



  template <int dim>
  std::unique_ptr<FittedShape<dim>>
  make_fitted_shape(const PointPlacement   &placement,
                    const std::string      &section,
                    const SplineSpace<dim> &space)
  {
    if (placement.shape_file.empty())
      return std::make_unique<LevelSetShape<dim>>(placement.shape,
                                                  section + "/Shape");
    const auto surface = read_surface<dim>(placement.shape_file,
                                           section + "/Shape file",
                                           placement.shape_file_unit);
    check_size<dim>(surface, placement, section, space);
    return std::make_unique<SurfaceShape<dim>>(surface, space.lattice());
  }



  template <int dim>
  std::vector<PlacedPoint<dim>>
  place_fitted_points(const PointPlacement   &placement,
                      const std::string      &section,
                      const SplineSpace<dim> &space)
  {
    Require(placement.jitter == 0.,
            "The parameter '" + section +
              "/Jitter' has to be 0 with 'Placement = " +
              word_of(placement.placement, placements) +
              "': jittered points do not follow the boundary.");
    const auto extents = points_of_cell<dim>(placement, section);
    const auto shape   = make_fitted_shape<dim>(placement, section, space);
    const auto whole =
      whole_cell<dim>(extents,
                      placement.placement == Placement::fitted_lattice);
    const unsigned int  n      = largest_of<dim>(extents);
    const unsigned int  degree = 2 * n - 1;
    const std::uint64_t n_per_cell =
      std::max<std::uint64_t>(whole.size(), n_polynomials<dim>(degree));
    check_ids(space, n_per_cell, section);

    std::vector<PlacedPoint<dim>> result;
    for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
      {
        const std::uint64_t position = space.owned_cells()[cell];
        const CellBox<dim>  box      = space.box(cell);
        if (!placement.clip)
          check_walls<dim>(*shape, space, box, section);
        CellPart<dim> part = shape->cut(box, n);
        double        sum  = 0.;
        for (const auto &point : part.points)
          sum += point.weight;
        if (!part.is_full && sum < smallest_part)
          continue;
        if (part.is_full)
          part.points = whole;
        else
          compress_quadrature(part.points, degree);
        std::uint64_t id = position * n_per_cell;
        for (const auto &point : part.points)
          if (point.weight > 0.)
            {
              const auto x = point_of_cell<dim>(point.x, box);
              result.push_back({x, x, point.weight * box.volume(), id++, cell});
            }
      }
    return result;
  }



  template <int dim>
  std::vector<SurfacePoint<dim>>
  place_surface_points(const PointPlacement   &placement,
                       const std::string      &section,
                       const SplineSpace<dim> &space)
  {
    const auto shape = make_fitted_shape<dim>(placement, section, space);
    const auto n     = largest_of<dim>(points_of_cell<dim>(placement, section));
    check_ids(space, surface_ids, section);

    std::vector<SurfacePoint<dim>> result;
    for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
      {
        const std::uint64_t position = space.owned_cells()[cell];
        const CellBox<dim>  box      = space.box(cell);
        if (!placement.clip)
          check_walls<dim>(*shape, space, box, section);
        const CellPart<dim> part = shape->cut(box, n);
        AssertThrow(part.surface.size() < surface_ids, ExcInternalError());
        std::uint64_t id = position * surface_ids;
        for (const auto &point : part.surface)
          {
            // Scale areas, as vectors, by the sides of the cell across them.
            SurfacePoint<dim> placed;
            placed.x      = point_of_cell<dim>(point.x, box);
            placed.normal = point.weight * point.normal;
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int e = 0; e < dim; ++e)
                if (e != d)
                  placed.normal[d] *= box.size[e];
            placed.area = placed.normal.norm();
            if (placed.area == 0.)
              continue;
            placed.normal /= placed.area;
            placed.cell = cell;
            placed.id   = id++;
            result.push_back(placed);
          }
      }
    return result;
  }



  GREVILLE_INSTANTIATE(make_fitted_shape);
  GREVILLE_INSTANTIATE(place_fitted_points);
  GREVILLE_INSTANTIATE(place_surface_points);
} // namespace greville

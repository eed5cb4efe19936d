// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/geometry/closest_surface.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Positions coincide if they are closer than this fraction of a cell.
    constexpr double same_place = 1e-13;

    // The number of facets whose planes are tried for a division. The plane
    // that divides the fewest other facets is chosen.
    constexpr unsigned int n_candidates = 6;



    /// Return a normal of any length.
    Tensor<1, 2>
    normal_of(const Facet<2> &facet)
    {
      const auto along = facet[1] - facet[0];
      return Tensor<1, 2>({along[1], -along[0]});
    }

    Tensor<1, 3>
    normal_of(const Facet<3> &facet)
    {
      // Sum over the triangles, since polygons may have lost corners.
      Tensor<1, 3> sum;
      for (unsigned int i = 1; i + 1 < facet.size(); ++i)
        sum += cross_product_3d(facet[i] - facet[0], facet[i + 1] - facet[0]);
      return sum;
    }



    template <int dim>
    Plane<dim>
    plane_of(const Facet<dim> &facet)
    {
      Plane<dim> plane;
      plane.normal = normal_of(facet);
      plane.normal /= plane.normal.norm();
      plane.offset = plane.normal * center_of<dim>(facet);
      return plane;
    }
  } // namespace



  template <int dim>
  SurfaceShape<dim>::SurfaceShape(ClosedSurface<dim>  given,
                                  const Lattice<dim> &lattice)
    : surface(std::move(given))
    , closest(make_closest_surface<dim>(surface))
    , lattice(lattice)
  {
    sort_by_cells();
  }



  template <int dim>
  SurfaceShape<dim>::~SurfaceShape() = default;



  template <int dim>
  template <typename Index>
  std::uint64_t
  SurfaceShape<dim>::cell_key(const Index &index) const
  {
    std::uint64_t key = 0;
    for (unsigned int d = 0; d < dim; ++d)
      key = key * (lattice.n_cells()[d] + 2) + (index[d] + 1);
    return key;
  }



  template <int dim>
  void
  SurfaceShape<dim>::sort_by_cells()
  {
    for (unsigned int f = 0; f < surface.size(); ++f)
      {
        const BoundingBox<dim> box(surface[f]);
        std::array<int, dim>   first, last;
        bool                   is_near = true;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const auto cell = [&](const double x, const double shift) {
              const double place = lattice.place(d, x) + shift;
              return int(std::floor(
                std::min(std::max(place, -2.), lattice.n_cells()[d] + 1.)));
            };
            first[d] = std::max(-1, cell(box.lower_bound(d), -1e-9));
            last[d]  = std::min<int>(lattice.n_cells()[d],
                                    cell(box.upper_bound(d), 1e-9));
            is_near  = is_near && first[d] <= last[d];
          }
        if (!is_near)
          continue;
        const Plane<dim> plane = plane_of<dim>(surface[f]);
        auto             cell  = first;
        while (cell[dim - 1] <= last[dim - 1])
          {
            Point<dim> center;
            double     radius = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              {
                const int    last_cell = lattice.n_cells()[d] - 1;
                const int    inside    = std::clamp(cell[d], 0, last_cell);
                const double h         = lattice.cell_size(d, inside);
                center[d] =
                  lattice.edge(d, inside) + (cell[d] - inside + 0.5) * h;
                radius += (0.5 + 1e-9) * h * std::abs(plane.normal[d]);
              }
            if (std::abs(plane.distance(center)) <= radius)
              by_cell.emplace_back(cell_key(cell), f);
            ++cell[0];
            for (unsigned int d = 0; d + 1 < dim && cell[d] > last[d]; ++d)
              {
                cell[d] = first[d];
                ++cell[d + 1];
              }
          }
      }
    std::sort(by_cell.begin(), by_cell.end());
  }



  template <int dim>
  bool
  SurfaceShape<dim>::contains(const Point<dim> &x) const
  {
    return closest->contains(x);
  }



  template <int dim>
  CellPart<dim>
  SurfaceShape<dim>::cut(const CellBox<dim> &cell, const unsigned int n) const
  {
    const std::uint64_t key = cell_key(cell.index);

    CellPart<dim>           part;
    std::vector<PlaneFacet> facets; // in coordinates of the cell
    for (auto entry =
           std::lower_bound(by_cell.begin(),
                            by_cell.end(),
                            std::pair<std::uint64_t, unsigned int>(key, 0));
         entry != by_cell.end() && entry->first == key;
         ++entry)
      {
        Facet<dim> facet = surface[entry->second], low, high;
        for (Point<dim> &x : facet)
          for (unsigned int d = 0; d < dim; ++d)
            x[d] = (x[d] - cell.lower[d]) / cell.size[d];
        const Plane<dim> plane   = plane_of<dim>(facet);
        bool             is_face = false, is_mine = true;
        for (unsigned int d = 0; d < dim && facet.size() >= dim; ++d)
          for (const int side : {-1, 1})
            {
              Plane<dim> face;
              face.normal[d] = side;
              face.offset    = side < 0 ? 0. : 1.;
              split_facet(facet, face, same_place, low, high);
              facet = low;
              if (std::all_of(facet.begin(), facet.end(), [&](const auto &x) {
                    return std::abs(face.distance(x)) <= same_place;
                  }))
                {
                  is_face = true;
                  is_mine = is_mine && plane.normal[d] * side > 0.;
                }
            }
        if (facet.size() < dim || normal_of(facet).norm() < 1e-20)
          continue;
        if (!is_face)
          facets.push_back({facet, plane});
        if (is_mine)
          append_quadrature(facet, plane.normal, n, part.surface);
      }
    if (facets.empty())
      part.is_full = contains(cell.center);
    else
      {
        cut_part(ConvexPart<dim>(create_unit_bounding_box<dim>()),
                 facets,
                 cell,
                 n,
                 part.points);
        double volume = 0.;
        for (const auto &point : part.points)
          volume += point.weight;
        if (volume > 1. - 1e-12)
          {
            part.is_full = true;
            part.points.clear();
          }
      }
    return part;
  }



  template <int dim>
  void
  SurfaceShape<dim>::cut_part(const ConvexPart<dim>           &part,
                              std::vector<PlaneFacet>          facets,
                              const CellBox<dim>              &cell,
                              const unsigned int               n,
                              std::vector<WeightedPoint<dim>> &points) const
  {
    ConvexPart<dim> below, above;
    Facet<dim>      low, high;
    while (!facets.empty())
      {
        unsigned int best = 0, fewest = -1;
        for (unsigned int k = 0;
             k < std::min<std::size_t>(facets.size(), n_candidates);
             ++k)
          {
            const std::size_t candidate = facets.size() <= n_candidates
                                            ? k
                                            : k * facets.size() / n_candidates;
            const Plane<dim> &plane     = facets[candidate].plane;
            unsigned int      divided   = 0;
            for (const auto &other : facets)
              {
                split_facet(other.facet, plane, same_place, low, high);
                divided += low.size() >= dim && high.size() >= dim;
              }
            if (divided < fewest)
              {
                best   = candidate;
                fewest = divided;
              }
          }
        const Plane<dim> plane = facets[best].plane;
        facets.erase(facets.begin() + best);
        if (!part.split(plane, same_place, below, above, low))
          continue;
        std::vector<PlaneFacet> facets_below, facets_above;
        for (const auto &other : facets)
          {
            if (std::all_of(other.facet.begin(),
                            other.facet.end(),
                            [&](const auto &x) {
                              return std::abs(plane.distance(x)) <= same_place;
                            }))
              continue;
            split_facet(other.facet, plane, same_place, low, high);
            if (low.size() >= dim && normal_of(low).norm() > 1e-20)
              facets_below.push_back({low, other.plane});
            if (high.size() >= dim && normal_of(high).norm() > 1e-20)
              facets_above.push_back({high, other.plane});
          }
        cut_part(below, facets_below, cell, n, points);
        cut_part(above, facets_above, cell, n, points);
        return;
      }
    Point<dim> center = part.center();
    for (unsigned int d = 0; d < dim; ++d)
      center[d] = cell.lower[d] + center[d] * cell.size[d];
    if (contains(center))
      part.append_quadrature(n, points);
  }



  GREVILLE_INSTANTIATE_CLASS(SurfaceShape);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/numerics/rtree.h>

#include <greville/base/errors.h>
#include <greville/geometry/closest_surface.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Points coincide if they are closer than this fraction of coordinates.
    constexpr double same_closest_point = 1e-13;



    /// A segment or a triangle, with its unit normal.
    template <int dim>
    struct FlatFacet
    {
      std::array<Point<dim>, dim> corners;
      Tensor<1, dim>              normal;
    };



    Point<2>
    closest_of(const FlatFacet<2> &facet, const Point<2> &x)
    {
      const auto &[a, b] = facet.corners;
      const auto   ab    = b - a;
      const double t     = (x - a) * ab / ab.norm_square();
      if (t <= 0.)
        return a;
      return t >= 1. ? b : a + t * ab;
    }



    Point<3>
    closest_of(const FlatFacet<3> &facet, const Point<3> &x)
    {
      // If x is above the triangle, the closest point is in its plane,
      // otherwise on the nearest edge.
      const auto &corners  = facet.corners;
      bool        is_above = true;
      Point<3>    result;
      double      smallest_square = std::numeric_limits<double>::max();
      for (unsigned int k = 0; k < 3; ++k)
        {
          const Point<3> &a  = corners[k];
          const auto      ab = corners[(k + 1) % 3] - a;
          if (cross_product_3d(facet.normal, ab) * (x - a) > 0.)
            continue;
          is_above              = false;
          const double   t      = (x - a) * ab / ab.norm_square();
          const Point<3> y      = t <= 0.   ? a
                                  : t >= 1. ? corners[(k + 1) % 3]
                                            : a + t * ab;
          const double   square = (x - y).norm_square();
          if (square < smallest_square)
            {
              smallest_square = square;
              result          = y;
            }
        }
      if (is_above)
        result = x - (facet.normal * (x - corners[0])) * facet.normal;
      return result;
    }



    /// Return the angle of the facet at one of its points, as a fraction of the
    /// full circle; in 2D, 1 or 1/2.
    template <int dim>
    double
    angle_at(const FlatFacet<dim> &facet,
             const Point<dim>     &y,
             const double          tolerance)
    {
      double result = 1.;
      for (unsigned int k = 0; k < dim; ++k)
        {
          const Point<dim> &a = facet.corners[k];
          const auto        b = facet.corners[(k + 1) % dim] - a;
          if (a.distance(y) < tolerance)
            {
              const auto   c      = facet.corners[(k + dim - 1) % dim] - a;
              const double cosine = b * c / (b.norm() * c.norm());
              return dim == 2 ? 0.5
                              : std::acos(std::max(-1., std::min(1., cosine))) /
                                  (2. * numbers::PI);
            }
          if constexpr (dim == 3)
            if (cross_product_3d(b, y - a).norm() < tolerance * b.norm())
              result = 0.5;
        }
      return result;
    }



    template <int dim>
    class ClosestFacet : public ClosestSurface<dim>
    {
    public:
      ClosestFacet(const ClosedSurface<dim> &surface);

      std::optional<ClosestPoint<dim>>
      closest(const Point<dim> &x, const double within) const override;

      bool
      contains(const Point<dim> &x) const override
      {
        for (unsigned int d = 0; d < dim; ++d)
          if (x[d] < extent.lower_bound(d) || x[d] > extent.upper_bound(d))
            return false;
        return closest(x, std::numeric_limits<double>::infinity())->distance <
               0.;
      }

      BoundingBox<dim>
      box() const override
      {
        return extent;
      }

      ClosedSurface<dim>
      mesh(const BoundingBox<dim> &) const override
      {
        ClosedSurface<dim> result;
        for (const FlatFacet<dim> &facet : facets)
          result.emplace_back(facet.corners.begin(), facet.corners.end());
        return result;
      }

    private:
      using Entry = std::pair<BoundingBox<dim>, unsigned int>;

      std::vector<FlatFacet<dim>> facets;
      RTree<Entry>                tree;
      BoundingBox<dim>            extent;
      double                      size        = 0.; // of coordinates
      double                      mean_extent = 0.; // of facets

      // Memory for searches: facets with near boxes, and facets with about the
      // smallest distance.
      mutable std::vector<Entry>                               found;
      mutable std::vector<std::pair<unsigned int, Point<dim>>> nearest;
    };



    template <int dim>
    ClosestFacet<dim>::ClosestFacet(const ClosedSurface<dim> &surface)
    {
      Require(!surface.empty(), "The surface has no facets.");
      std::vector<Entry> entries;
      for (const Facet<dim> &corners : surface)
        {
          AssertThrow(corners.size() == dim,
                      ExcDimensionMismatch(corners.size(), dim));
          FlatFacet<dim> facet;
          std::copy(corners.begin(), corners.end(), facet.corners.begin());
          const auto along = corners[1] - corners[0];
          if constexpr (dim == 2)
            facet.normal = Tensor<1, 2>({along[1], -along[0]});
          else
            facet.normal = cross_product_3d(along, corners[2] - corners[0]);
          facet.normal /= facet.normal.norm();
          entries.emplace_back(BoundingBox<dim>(corners), facets.size());
          facets.push_back(facet);
          mean_extent += along.norm() / surface.size();
          for (const Point<dim> &corner : corners)
            size = std::max(size, corner.norm());
        }
      extent = entries[0].first;
      for (const Entry &entry : entries)
        extent.merge_with(entry.first);
      tree = pack_rtree(entries);
    }



    template <int dim>
    std::optional<ClosestPoint<dim>>
    ClosestFacet<dim>::closest(const Point<dim> &x, const double within) const
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (std::max(extent.lower_bound(d) - x[d],
                     x[d] - extent.upper_bound(d)) > within)
          return std::nullopt;
      const double tolerance         = same_closest_point * (x.norm() + size);
      double       smallest_distance = within + tolerance;
      // First, a few near facets bound the distance, unless facets are about as
      // large as the search distance: then few facets are within it.
      for (const bool is_last : {false, true})
        {
          if (!is_last && within < mean_extent)
            continue;
          namespace bgi  = boost::geometry::index;
          Point<dim> low = x, high = x;
          for (unsigned int d = 0; d < dim; ++d)
            {
              low[d] -= smallest_distance + tolerance;
              high[d] += smallest_distance + tolerance;
            }
          const BoundingBox<dim> around({low, high});
          found.clear();
          if (is_last)
            tree.query(bgi::intersects(around), std::back_inserter(found));
          else
            tree.query(bgi::nearest(x, 8), std::back_inserter(found));
          nearest.clear();
          for (const Entry &entry : found)
            {
              const Point<dim> y        = closest_of(facets[entry.second], x);
              const double     distance = x.distance(y);
              if (distance > smallest_distance + tolerance)
                continue;
              smallest_distance = std::min(smallest_distance, distance);
              nearest.emplace_back(entry.second, y);
            }
        }
      // These distances may differ from the ones above in the last bit.
      const Point<dim> *point = nullptr;
      smallest_distance       = std::numeric_limits<double>::infinity();
      for (const auto &[facet, y] : nearest)
        if (x.distance(y) <= smallest_distance)
          {
            smallest_distance = x.distance(y);
            point             = &y;
          }
      if (point == nullptr || smallest_distance > within)
        return std::nullopt;

      ClosestPoint<dim> result;
      result.point = *point;
      Tensor<1, dim> sum;
      double         largest = 0.;
      unsigned int   widest  = 0;
      for (const auto &[facet, y] : nearest)
        // Other points may have about the same distance.
        if (y.distance(*point) < 4. * tolerance)
          {
            const double angle =
              angle_at(facets[facet], *point, 4. * tolerance);
            sum += angle * facets[facet].normal;
            if (angle > largest)
              {
                largest = angle;
                widest  = facet;
              }
          }
      const Tensor<1, dim> towards = x - *point;
      const double         side    = towards * sum < 0. ? -1. : 1.;
      result.distance              = side * smallest_distance;
      if (largest == 1.)
        result.normal = facets[widest].normal;
      else if (smallest_distance > 10. * tolerance)
        result.normal = side / smallest_distance * towards;
      else
        result.normal = sum / sum.norm();
      return result;
    }
  } // namespace



  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(const ClosedSurface<dim> &surface)
  {
    return std::make_unique<ClosestFacet<dim>>(surface);
  }



  template std::unique_ptr<ClosestSurface<2>>
  make_closest_surface(const ClosedSurface<2> &);
  template std::unique_ptr<ClosestSurface<3>>
  make_closest_surface(const ClosedSurface<3> &);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/numerics/rtree.h>

#include <greville/geometry/closest_surface.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Points are the same that are closer than this part of coordinates.
    constexpr double same_closest_point = 1e-13;



    /**
     * A segment or a triangle, with its unit normal.
     */
    template <int dim>
    struct FlatFacet
    {
      std::array<Point<dim>, dim> corners;
      Tensor<1, dim>              normal;
    };



    /**
     * The closest point of a facet.
     */
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
      // The plane where x is above the triangle, else the nearest of its edges.
      const auto &corners  = facet.corners;
      bool        is_above = true;
      Point<3>    result;
      double      least = std::numeric_limits<double>::max();
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
          if (square < least)
            {
              least  = square;
              result = y;
            }
        }
      if (is_above)
        result = x - (facet.normal * (x - corners[0])) * facet.normal;
      return result;
    }



    /**
     * The angle under which a facet is seen from a point of it: as a share of
     * the full circle, in 2D 1 or 1/2.
     */
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
      ClosestFacet(ClosedSurface<dim> surface);

      std::optional<ClosestPoint<dim>>
      closest(const Point<dim> &x, const double within) const override;

      BoundingBox<dim>
      box() const override
      {
        return BoundingBox<dim>({lower, upper});
      }

      ClosedSurface<dim>
      facets(const double, const BoundingBox<dim> &) const override
      {
        return surface;
      }

    private:
      using Entry = std::pair<BoundingBox<dim>, unsigned int>;

      ClosedSurface<dim>          surface;
      std::vector<FlatFacet<dim>> flat_facets;
      RTree<Entry>                tree;
      Point<dim>                  lower, upper;

      // For searches: facets with near boxes, those at about the least
      // distance.
      mutable std::vector<Entry>                               found;
      mutable std::vector<std::pair<unsigned int, Point<dim>>> nearest;
    };



    template <int dim>
    ClosestFacet<dim>::ClosestFacet(ClosedSurface<dim> given)
      : surface(std::move(given))
    {
      Assert(!surface.empty(), ExcMessage("The surface has no facets."));
      std::vector<Entry> entries;
      lower = upper = surface[0][0];
      for (const Facet<dim> &corners : surface)
        {
          AssertDimension(corners.size(), dim);
          FlatFacet<dim> facet;
          std::copy(corners.begin(), corners.end(), facet.corners.begin());
          const auto along = corners[1] - corners[0];
          if constexpr (dim == 2)
            facet.normal = Tensor<1, 2>({along[1], -along[0]});
          else
            facet.normal = cross_product_3d(along, corners[2] - corners[0]);
          facet.normal /= facet.normal.norm();
          entries.emplace_back(BoundingBox<dim>(corners), flat_facets.size());
          flat_facets.push_back(facet);
          for (const Point<dim> &corner : corners)
            for (unsigned int d = 0; d < dim; ++d)
              {
                lower[d] = std::min(lower[d], corner[d]);
                upper[d] = std::max(upper[d], corner[d]);
              }
        }
      tree = pack_rtree(entries);
    }



    template <int dim>
    std::optional<ClosestPoint<dim>>
    ClosestFacet<dim>::closest(const Point<dim> &x, const double within) const
    {
      namespace bgi = boost::geometry::index;
      double size   = within;
      // No more than from the box to its far end.
      double far = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const double outside = std::max(lower[d] - x[d], x[d] - upper[d]);
          if (outside > within)
            return std::nullopt;
          far += std::pow(std::max(x[d] - lower[d], upper[d] - x[d]), 2);
        }
      size                   = std::min(size, std::sqrt(far));
      const double tolerance = same_closest_point * (x.norm() + std::sqrt(far));
      size += tolerance;
      double least = size;
      // Facets by the distance of their boxes, until none that is left out can
      // be nearer.
      for (unsigned int k = 8;; k *= 8)
        {
          Point<dim> low = x, high = x;
          for (unsigned int d = 0; d < dim; ++d)
            {
              low[d] -= least + tolerance;
              high[d] += least + tolerance;
            }
          nearest.clear();
          found.clear();
          tree.query(bgi::intersects(BoundingBox<dim>({low, high})) &&
                       bgi::nearest(x, k),
                     std::back_inserter(found));
          double furthest_box = 0.;
          for (const Entry &entry : found)
            {
              double to_box = 0.;
              for (unsigned int d = 0; d < dim; ++d)
                to_box += std::pow(std::max({entry.first.lower_bound(d) - x[d],
                                             x[d] - entry.first.upper_bound(d),
                                             0.}),
                                   2);
              furthest_box       = std::max(furthest_box, to_box);
              const Point<dim> y = closest_of(flat_facets[entry.second], x);
              const double     distance = x.distance(y);
              if (distance > least + tolerance)
                continue;
              least = std::min(least, distance);
              nearest.emplace_back(entry.second, y);
            }
          if (found.size() < k || std::sqrt(furthest_box) > least + tolerance)
            break;
        }
      const Point<dim> *point = nullptr;
      for (const auto &[facet, y] : nearest)
        if (x.distance(y) == least)
          point = &y;
      if (point == nullptr || least > within)
        return std::nullopt;

      ClosestPoint<dim> result;
      result.point = *point;
      Tensor<1, dim> sum;
      double         largest = 0.;
      unsigned int   widest  = 0;
      for (const auto &[facet, y] : nearest)
        // At about the same distance there may be other places.
        if (y.distance(*point) < 4. * tolerance)
          {
            const double angle =
              angle_at(flat_facets[facet], *point, 4. * tolerance);
            sum += angle * flat_facets[facet].normal;
            if (angle > largest)
              {
                largest = angle;
                widest  = facet;
              }
          }
      const Tensor<1, dim> towards = x - *point;
      const double         side    = towards * sum < 0. ? -1. : 1.;
      result.distance              = side * least;
      if (largest == 1.)
        result.normal = flat_facets[widest].normal;
      else if (least > 10. * tolerance)
        result.normal = side / least * towards;
      else
        result.normal = sum / sum.norm();
      return result;
    }
  } // namespace



  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(ClosedSurface<dim> surface)
  {
    return std::make_unique<ClosestFacet<dim>>(std::move(surface));
  }



  template std::unique_ptr<ClosestSurface<2>>
    make_closest_surface(ClosedSurface<2>);
  template std::unique_ptr<ClosestSurface<3>>
    make_closest_surface(ClosedSurface<3>);
} // namespace greville

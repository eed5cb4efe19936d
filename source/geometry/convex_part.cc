// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/compatibility.h>
#include <greville/geometry/convex_part.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Call @p visit with the n corners of each simplex in @p facet.
    template <int dim, typename Visit>
    void
    for_each_simplex(const Facet<dim> &facet, const Visit &visit)
    {
      if (dim == 2)
        visit(std::array<Point<dim>, dim>{{facet[0], facet[1]}});
      else
        for (unsigned int i = 1; i + 1 < facet.size(); ++i)
          {
            std::array<Point<dim>, dim> corners;
            corners[0]       = facet[0];
            corners[1]       = facet[i];
            corners[dim - 1] = facet[i + 1];
            visit(corners);
          }
    }



    /// Return dim - 1 times the area of a simplex with dim corners.
    double
    area_of(const std::array<Point<2>, 2> &corners)
    {
      return corners[0].distance(corners[1]);
    }

    double
    area_of(const std::array<Point<3>, 3> &corners)
    {
      return cross_product_3d(corners[1] - corners[0], corners[2] - corners[0])
        .norm();
    }



    /// Return the part of a plane with the given points on its edge, in any
    /// order.
    Facet<2>
    facet_around(const Facet<2> &points, const Plane<2> &plane)
    {
      const Tensor<1, 2> along({-plane.normal[1], plane.normal[0]});
      const auto         ends =
        std::minmax_element(points.begin(),
                            points.end(),
                            [&](const Point<2> &a, const Point<2> &b) {
                              return along * a < along * b;
                            });
      return {*ends.first, *ends.second};
    }

    Facet<3>
    facet_around(const Facet<3> &points, const Plane<3> &plane)
    {
      const Point<3> center   = center_of<3>(points);
      unsigned int   smallest = 0;
      for (unsigned int d = 1; d < 3; ++d)
        if (std::abs(plane.normal[d]) < std::abs(plane.normal[smallest]))
          smallest = d;
      Tensor<1, 3> axis;
      axis[smallest]       = 1.;
      const Tensor<1, 3> a = cross_product_3d(plane.normal, axis);
      const Tensor<1, 3> b = cross_product_3d(plane.normal, a);
      std::vector<std::pair<double, Point<3>>> sorted;
      for (const Point<3> &x : points)
        sorted.emplace_back(std::atan2(b * (x - center), a * (x - center)), x);
      std::sort(sorted.begin(),
                sorted.end(),
                [](const auto &one, const auto &other) {
                  return one.first < other.first;
                });
      Facet<3> result;
      for (const auto &entry : sorted)
        result.push_back(entry.second);
      return result;
    }



    /// Return the Gauss points of [0, 1], which deal.II would compute again in
    /// each call.
    const Quadrature<1> &
    gauss(const unsigned int n)
    {
      static thread_local std::deque<Quadrature<1>> known;
      while (known.size() <= n)
        known.emplace_back(QGauss<1>(std::max<std::size_t>(1, known.size())));
      return known[n];
    }



    /// Call @p visit(coordinates, weight) with the quadrature points of a
    /// simplex. The coordinates belong to all corners except the first one. The
    /// weights add up to 1 / d!.
    template <typename Visit>
    void
    for_each_simplex_point(std::integral_constant<int, 1>,
                           const unsigned int n,
                           const Visit       &visit)
    {
      const auto &rule = gauss(n);
      for (unsigned int i = 0; i < n; ++i)
        visit(std::array<double, 1>{{rule.point(i)[0]}}, rule.weight(i));
    }

    template <int d, typename Visit>
    void
    for_each_simplex_point(std::integral_constant<int, d>,
                           const unsigned int n,
                           const Visit       &visit)
    {
      // Shrink the rule of d - 1 coordinates towards the first corner. The
      // factor r^(d - 1) requires one more point.
      const auto &rule = gauss(n + 1);
      for (unsigned int i = 0; i < rule.size(); ++i)
        {
          const double r = rule.point(i)[0];
          for_each_simplex_point(std::integral_constant<int, d - 1>(),
                                 n,
                                 [&](const auto &inner, const double weight) {
                                   std::array<double, d> all;
                                   double                sum = 0.;
                                   for (int k = 0; k < d - 1; ++k)
                                     {
                                       all[k] = r * inner[k];
                                       sum += all[k];
                                     }
                                   all[d - 1] = r - sum;
                                   visit(all,
                                         weight * rule.weight(i) *
                                           std::pow(r, d - 1));
                                 });
        }
    }
  } // namespace



  template <int dim>
  void
  split_facet(const Facet<dim> &facet,
              const Plane<dim> &plane,
              const double      tolerance,
              Facet<dim>       &below,
              Facet<dim>       &above)
  {
    below.clear();
    above.clear();
    bool               has_below = false, has_above = false;
    const unsigned int n = facet.size();
    for (unsigned int i = 0; i < n; ++i)
      {
        const double a = plane.distance(facet[i]);
        const double b = plane.distance(facet[(i + 1) % n]);
        has_below      = has_below || a < -tolerance;
        has_above      = has_above || a > tolerance;
        if (a <= tolerance)
          below.push_back(facet[i]);
        if (a >= -tolerance)
          above.push_back(facet[i]);
        // A segment has one edge only.
        if (std::min(a, b) < -tolerance && std::max(a, b) > tolerance &&
            (dim == 3 || i == 0))
          {
            const Point<dim> x =
              facet[i] + a / (a - b) * (facet[(i + 1) % n] - facet[i]);
            below.push_back(x);
            above.push_back(x);
          }
      }
    if (!has_above)
      {
        below = facet;
        above.clear();
      }
    else if (!has_below)
      {
        above = facet;
        below.clear();
      }
  }



  template <int dim>
  Point<dim>
  center_of(const Facet<dim> &facet)
  {
    Point<dim> center;
    for (const Point<dim> &x : facet)
      center += x / double(facet.size());
    return center;
  }



  template <int dim>
  void
  append_quadrature(const Facet<dim>                       &facet,
                    const Tensor<1, dim>                   &normal,
                    const unsigned int                      n,
                    std::vector<WeightedSurfacePoint<dim>> &points)
  {
    for_each_simplex<dim>(facet, [&](const auto &corners) {
      const double area = area_of(corners);
      if (area > 0.)
        for_each_simplex_point(std::integral_constant<int, dim - 1>(),
                               n,
                               [&](const auto  &coordinates,
                                   const double weight) {
                                 Point<dim> x = corners[0];
                                 for (unsigned int k = 1; k < dim; ++k)
                                   x += coordinates[k - 1] *
                                        (corners[k] - corners[0]);
                                 points.push_back({x, normal, weight * area});
                               });
    });
  }



  template <int dim>
  ConvexPart<dim>::ConvexPart(const BoundingBox<dim> &box)
  {
    const auto &ends = box.get_boundary_points();
    for (unsigned int d = 0; d < dim; ++d)
      for (const Point<dim> &end : {ends.first, ends.second})
        {
          Facet<dim>       facet;
          const Point<dim> corners[2] = {ends.first, ends.second};
          for (const auto &choice : {std::array<unsigned int, 2>{{0, 0}},
                                     std::array<unsigned int, 2>{{1, 0}},
                                     std::array<unsigned int, 2>{{1, 1}},
                                     std::array<unsigned int, 2>{{0, 1}}})
            {
              if (dim == 2 && choice[1] == 1)
                continue;
              Point<dim> x;
              for (unsigned int e = 0, k = 0; e < dim; ++e)
                x[e] = e == d ? end[e] : corners[choice[k++]][e];
              facet.push_back(x);
            }
          facets.push_back(facet);
        }
  }



  template <int dim>
  bool
  ConvexPart<dim>::split(const Plane<dim> &plane,
                         const double      tolerance,
                         ConvexPart       &below,
                         ConvexPart       &above,
                         Facet<dim>       &cut) const
  {
    double lowest = 0., highest = 0.;
    for (const Facet<dim> &facet : facets)
      for (const Point<dim> &x : facet)
        {
          const double distance = plane.distance(x);
          lowest                = std::min(lowest, distance);
          highest               = std::max(highest, distance);
        }
    if (lowest >= -tolerance || highest <= tolerance)
      return false;

    below.facets.clear();
    above.facets.clear();
    Facet<dim> rim, low, high;
    for (const Facet<dim> &facet : facets)
      {
        split_facet(facet, plane, tolerance, low, high);
        for (const Facet<dim> *part : {&low, &high})
          for (const Point<dim> &x : *part)
            if (std::abs(plane.distance(x)) <= tolerance &&
                std::none_of(rim.begin(), rim.end(), [&](const auto &other) {
                  return x.distance(other) <= 2. * tolerance;
                }))
              rim.push_back(x);
        if (low.size() >= dim)
          below.facets.push_back(low);
        if (high.size() >= dim)
          above.facets.push_back(high);
      }
    if (rim.size() < dim)
      return false;
    cut = facet_around(rim, plane);
    below.facets.push_back(cut);
    above.facets.push_back(cut);
    return true;
  }



  template <int dim>
  Point<dim>
  ConvexPart<dim>::center() const
  {
    Point<dim> center;
    for (const Facet<dim> &facet : facets)
      center += center_of<dim>(facet) / double(facets.size());
    return center;
  }



  template <int dim>
  void
  ConvexPart<dim>::append_quadrature(
    const unsigned int n, std::vector<WeightedPoint<dim>> &points) const
  {
    const Point<dim> apex = facets.front().front();
    // The largest measure that round-off can cause.
    double size = 0.;
    for (const Facet<dim> &facet : facets)
      for (const Point<dim> &x : facet)
        size = std::max(size, x.distance(apex));
    for (const Facet<dim> &facet : facets)
      for_each_simplex<dim>(facet, [&](const auto &corners) {
        Tensor<2, dim> edges;
        for (unsigned int k = 0; k < dim; ++k)
          edges[k] = corners[k] - apex;
        const double volume = std::abs(determinant(edges));
        if (volume > 1e-15 * std::pow(size, dim))
          for_each_simplex_point(std::integral_constant<int, dim>(),
                                 n,
                                 [&](const auto  &coordinates,
                                     const double weight) {
                                   Point<dim> x = apex;
                                   for (unsigned int k = 0; k < dim; ++k)
                                     x += coordinates[k] * edges[k];
                                   points.push_back({x, weight * volume});
                                 });
      });
  }



  GREVILLE_INSTANTIATE(split_facet);
  GREVILLE_INSTANTIATE(center_of);
  GREVILLE_INSTANTIATE(append_quadrature);
  GREVILLE_INSTANTIATE_CLASS(ConvexPart);
} // namespace greville

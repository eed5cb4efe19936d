// SPDX-License-Identifier: LGPL-2.1-or-later

#include "closest_shape.h"

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    using internal::ConstrainedPoint;
    using internal::Edge;

    // Rays for surfaces of formulas end at these parts of the distance.
    constexpr double ray_parts[3] = {0.35, 0.65, 0.95};

    // Searches from other points than x.
    constexpr unsigned int most_searches = 12;

    // Of a level set that is not searched.
    constexpr double infinitely_far = std::numeric_limits<double>::max();



    template <int dim>
    class ClosestOfShape : public ClosestSurface<dim>
    {
    public:
      ClosestOfShape(const std::string &formula, const std::string &parameter);

      std::optional<ClosestPoint<dim>>
      closest(const Point<dim> &x, const double within) const override;

      BoundingBox<dim>
      box() const override
      {
        return extent;
      }

      ClosedSurface<dim>
      facets(const double size, const BoundingBox<dim> &clip) const override
      {
        return internal::facets_of(shape, size, clip);
      }

    private:
      /**
       * The nearest point of the surface so far.
       */
      struct Best
      {
        double                        distance;
        double                        length; // for differences
        Point<dim>                    point;
        std::array<unsigned int, dim> level_sets{};
        unsigned int                  n        = 0; // level sets
        bool                          is_found = false;
      };

      /**
       * Take @p y if it is nearer and on the surface.
       */
      bool
      take(const Point<dim>                    &x,
           const Point<dim>                    &y,
           const std::array<unsigned int, dim> &level_sets,
           const unsigned int                   n,
           Best                                &best) const;

      void
      take_edges(const Point<dim> &x, Best &best) const;

      /**
       * Points that are closest to @p x on level sets of formulas and where
       * they meet others, by Newton's method from @p start.
       */
      void
      search(const Point<dim> &x, const Point<dim> &start, Best &best) const;

      /**
       * Call @p visit(level_sets, n) for all level sets of formulas, and all
       * pairs and triples that contain one.
       */
      template <typename Visit>
      void
      visit_choices(const Visit &visit) const;

      /**
       * Points all over the surfaces and edges of formulas of a bounded body.
       */
      void
      find_seeds();

      /**
       * As search(), for each surface or edge from the nearest seed.
       */
      void
      search_from_seeds(const Point<dim> &x, Best &best) const;

      /**
       * The same from where rays from @p x meet the surface.
       */
      void
      search_along_rays(const Point<dim> &x,
                        const bool        is_inside,
                        Best             &best) const;

      /**
       * Whether a formula is zero nowhere around, as samples say.
       */
      bool
      is_far(const LevelSet<dim> &level_set,
             const Point<dim>    &x,
             const double         within) const;

      internal::SidesOfShape<dim>        shape;
      BoundingBox<dim>                   extent;
      std::vector<Edge>                  edges;
      std::vector<internal::Corner<dim>> corners;
      std::vector<Tensor<1, dim>>        rays;

      // On these level sets.
      struct Seeds
      {
        std::array<unsigned int, dim> level_sets;
        unsigned int                  n;
        std::vector<Point<dim>>       points;
      };
      std::vector<Seeds> seeds;

      // By level set, of the current x: no less than this, 0 where unknown.
      mutable std::vector<double> distances;
    };



    template <int dim>
    ClosestOfShape<dim>::ClosestOfShape(const std::string &formula,
                                        const std::string &parameter)
      : shape(formula, parameter)
      , extent(shape.box())
    {
      const auto &all = shape.level_sets();
      distances.assign(all.size(), 0.);
      std::vector<internal::Corner<dim>> points;
      if constexpr (dim == 3)
        {
          edges = internal::find_edges(all, shape.numbers, shape.length);
          points =
            internal::find_corners(all, shape.numbers, edges, shape.length);
        }
      else
        points = internal::find_corners(all, shape.numbers, shape.length);
      for (const auto &point : points)
        // Formulas may be undefined far away.
        if (shape.has_formulas ||
            shape.is_on_surface(point.x, point.level_sets, dim, shape.length))
          corners.push_back(point);
      unsigned int n_rays = 1;
      for (unsigned int d = 0; d < dim; ++d)
        n_rays *= 3;
      if (shape.has_formulas)
        for (unsigned int k = 0; k < n_rays; ++k)
          if (k != n_rays / 2)
            {
              // Not along axes, which formulas like.
              Tensor<1, dim> ray;
              for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
                ray[d] = rest % 3 - 1. + 0.1 * (d + 1.);
              rays.push_back(ray / ray.norm());
            }
      find_seeds();
    }



    template <int dim>
    bool
    ClosestOfShape<dim>::take(const Point<dim>                    &x,
                              const Point<dim>                    &y,
                              const std::array<unsigned int, dim> &level_sets,
                              const unsigned int                   n,
                              Best                                &best) const
    {
      const double distance = x.distance(y);
      if (!(distance < best.distance) ||
          !shape.is_on_surface(y, level_sets, n, best.length))
        return false;
      best.distance   = distance;
      best.point      = y;
      best.level_sets = level_sets;
      best.n          = n;
      best.is_found   = true;
      return true;
    }



    template <int dim>
    void
    ClosestOfShape<dim>::take_edges(const Point<dim> &x, Best &best) const
    {
      if constexpr (dim == 3)
        for (const Edge &edge : edges)
          {
            const unsigned int a = edge.level_sets[0], b = edge.level_sets[1];
            if (distances[a] >= best.distance || distances[b] >= best.distance)
              continue;
            const auto   towards = x - edge.center;
            const double along   = edge.direction * towards;
            if (edge.kind == Edge::line)
              take(x, edge.center + along * edge.direction, {{a, b}}, 2, best);
            else if (edge.kind == Edge::circle)
              {
                const auto   out      = towards - along * edge.direction;
                const double distance = out.norm();
                take(x,
                     distance > 1e-14 * edge.radius
                       ? edge.center + edge.radius / distance * out
                       : edge.center + edge.radius * edge.across,
                     {{a, b}},
                     2,
                     best);
              }
            else
              {
                const ConstrainedPoint<dim> point({{&shape.level_sets()[a],
                                                    &shape.level_sets()[b]}},
                                                  2,
                                                  best.length);
                edge.visit_minima(
                  [&](const Point<3> &y) { return (x - y).norm_square(); },
                  [&](Point<3> y) {
                    if (point.approach(x, y))
                      take(x, y, {{a, b}}, 2, best);
                  });
              }
          }
    }



    template <int dim>
    template <typename Visit>
    void
    ClosestOfShape<dim>::visit_choices(const Visit &visit) const
    {
      const auto                   &numbers = shape.numbers;
      std::array<unsigned int, dim> chosen{};
      const auto                    try_chosen = [&](const unsigned int n) {
        for (unsigned int i = 0; i < n; ++i)
          if (shape.level_sets()[chosen[i]].kind == LevelSet<dim>::formula)
            {
              visit(chosen, n);
              return;
            }
      };
      for (unsigned int i = 0; i < numbers.size(); ++i)
        {
          chosen[0] = numbers[i];
          try_chosen(1);
        }
      for (unsigned int i = 0; i < numbers.size(); ++i)
        for (unsigned int j = 0; j < i; ++j)
          {
            chosen[0] = numbers[i];
            chosen[1] = numbers[j];
            try_chosen(2);
            if constexpr (dim == 3)
              for (unsigned int k = 0; k < j; ++k)
                {
                  chosen[2] = numbers[k];
                  try_chosen(3);
                }
          }
    }



    template <int dim>
    void
    ClosestOfShape<dim>::find_seeds()
    {
      bool   is_finite = shape.has_formulas;
      double size      = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        {
          is_finite = is_finite && std::isfinite(extent.lower_bound(d)) &&
                      std::isfinite(extent.upper_bound(d));
          size = std::max(size, extent.side_length(d));
        }
      if (!is_finite)
        return;
      visit_choices([&](const std::array<unsigned int, dim> &chosen,
                        const unsigned int                   n) {
        const ConstrainedPoint<dim> point(shape.pointers(chosen, n),
                                          n,
                                          std::min(size, 1.));
        Seeds                       found    = {chosen, n, {}};
        const unsigned int          n_starts = dim == 2 ? 12 : n == 3 ? 4 : 6;
        for (unsigned int k = 0; k < std::pow(n_starts, dim); ++k)
          {
            Point<dim> y;
            for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= n_starts)
              y[d] = extent.lower_bound(d) +
                     (rest % n_starts + 0.5) / n_starts * extent.side_length(d);
            try
              {
                if (point.restore(y) &&
                    std::none_of(found.points.begin(),
                                 found.points.end(),
                                 [&](const Point<dim> &other) {
                                   return y.distance(other) < 1e-9 * size;
                                 }) &&
                    shape.is_on_surface(y, chosen, n, std::min(size, 1.)))
                  found.points.push_back(y);
              }
            catch (const std::exception &)
              {
                // A formula is undefined there.
              }
          }
        if (!found.points.empty())
          seeds.push_back(found);
      });
    }



    template <int dim>
    void
    ClosestOfShape<dim>::search_from_seeds(const Point<dim> &x,
                                           Best             &best) const
    {
      for (const Seeds &some : seeds)
        {
          bool is_far = false;
          for (unsigned int i = 0; i < some.n; ++i)
            is_far = is_far || distances[some.level_sets[i]] == infinitely_far;
          if (is_far)
            continue;
          const Point<dim> *nearest = &some.points[0];
          for (const Point<dim> &y : some.points)
            if ((x - y).norm_square() < (x - *nearest).norm_square())
              nearest = &y;
          const ConstrainedPoint<dim> point(
            shape.pointers(some.level_sets, some.n), some.n, best.length);
          Point<dim> y = *nearest;
          if (point.approach(x, y))
            take(x, y, some.level_sets, some.n, best);
        }
    }



    template <int dim>
    void
    ClosestOfShape<dim>::search(const Point<dim> &x,
                                const Point<dim> &start,
                                Best             &best) const
    {
      visit_choices(
        [&](const std::array<unsigned int, dim> &chosen, const unsigned int n) {
          if (distances[chosen[0]] == infinitely_far)
            return;
          for (unsigned int i = 0; i < n; ++i)
            if (n > 1 && distances[chosen[i]] >= best.distance)
              return;
          const ConstrainedPoint<dim> point(shape.pointers(chosen, n),
                                            n,
                                            best.length);
          Point<dim>                  y = start;
          if (!point.approach(x, y))
            return;
          take(x, y, chosen, n, best);
          // What other level sets have in common with it is further away.
          double &distance = distances[chosen[0]];
          if (n == 1 && (distance == 0. || x.distance(y) < distance))
            distance = x.distance(y);
        });
    }



    template <int dim>
    void
    ClosestOfShape<dim>::search_along_rays(const Point<dim> &x,
                                           const bool        is_inside,
                                           Best             &best) const
    {
      // Without any point so far, in balls that grow.
      const bool   is_unbounded = std::isinf(best.distance);
      double       radius       = is_unbounded ? best.length : best.distance;
      unsigned int n_searches   = 0;
      for (unsigned int growth = 0; growth < (is_unbounded ? 40 : 1); ++growth)
        {
          for (const Tensor<1, dim> &ray : rays)
            {
              double before = 0.;
              for (const double part : ray_parts)
                {
                  double after = part * std::min(radius, best.distance);
                  if (shape.is_inside(x + after * ray) == is_inside)
                    {
                      before = after;
                      continue;
                    }
                  for (unsigned int k = 0; k < 12; ++k)
                    {
                      const double middle = 0.5 * (before + after);
                      (shape.is_inside(x + middle * ray) == is_inside ? before
                                                                      : after) =
                        middle;
                    }
                  search(x, x + 0.5 * (before + after) * ray, best);
                  if (++n_searches == most_searches && !is_unbounded)
                    return;
                  break;
                }
            }
          if (n_searches > 0)
            break;
          radius *= 2.;
        }
      if (is_unbounded && best.is_found)
        search_along_rays(x, is_inside, best);
    }



    template <int dim>
    bool
    ClosestOfShape<dim>::is_far(const LevelSet<dim> &level_set,
                                const Point<dim>    &x,
                                const double         within) const
    {
      if (!(within < 1e3 * (1. + shape.length + x.norm())))
        return false;
      const double value  = level_set.value(x);
      double       change = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        for (const int side : {-1, 1})
          {
            Point<dim> shifted = x;
            shifted[d] += side * within;
            change =
              std::max(change, std::abs(level_set.value(shifted) - value));
          }
      return std::abs(value) > 2. * std::sqrt(double(dim)) * change;
    }



    template <int dim>
    std::optional<ClosestPoint<dim>>
    ClosestOfShape<dim>::closest(const Point<dim> &x, const double within) const
    {
      double outside_of_box = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        outside_of_box = std::max({outside_of_box,
                                   extent.lower_bound(d) - x[d],
                                   x[d] - extent.upper_bound(d)});
      if (outside_of_box > within)
        return std::nullopt;

      const auto &all = shape.level_sets();
      Best        best;
      // Also what is at this distance.
      best.distance =
        within + 1e-15 * (shape.length + x.norm() + std::abs(within));
      // Differences over less would be round-off.
      best.length =
        std::max(std::min(within, 1.), 1e-4 * (shape.length + x.norm()));
      bool has_formulas = false;
      for (const unsigned int k : shape.numbers)
        {
          if (all[k].kind == LevelSet<dim>::formula)
            {
              const bool far = is_far(all[k], x, within);
              distances[k]   = far ? infinitely_far : 0.;
              has_formulas   = has_formulas || !far;
              continue;
            }
          const Point<dim> y = internal::project(all[k], x);
          distances[k]       = x.distance(y);
          std::array<unsigned int, dim> chosen{};
          chosen[0] = k;
          take(x, y, chosen, 1, best);
        }
      take_edges(x, best);
      for (const auto &corner : corners)
        take(x, corner.x, corner.level_sets, dim, best);
      const bool is_inside = shape.is_inside(x);
      if (has_formulas)
        {
          search(x, x, best);
          // Corners next to the point so far, to which Newton's method does
          // not come from x.
          const auto search_again = [&]() {
            double last = infinitely_far;
            while (shape.numbers.size() > 1 && best.is_found &&
                   best.distance < last)
              {
                last = best.distance;
                search(x, Point<dim>(best.point), best);
              }
          };
          search_from_seeds(x, best);
          search_again();
          search_along_rays(x, is_inside, best);
          search_again();
        }
      if (!best.is_found)
        return std::nullopt;

      ClosestPoint<dim> result;
      result.point      = best.point;
      result.distance   = is_inside ? -best.distance : best.distance;
      const double tiny = 1e-12 * (shape.length + x.norm() + best.point.norm());
      const Tensor<1, dim> towards = x - best.point;
      if (best.distance > tiny && best.n == 1)
        {
          result.normal = internal::derivatives(all[best.level_sets[0]],
                                                best.point,
                                                best.length,
                                                false)
                            .gradient;
          if (result.normal * towards * result.distance < 0.)
            result.normal = -result.normal;
        }
      else if (best.distance <= tiny)
        shape.is_on_surface(
          best.point, best.level_sets, best.n, best.length, &result.normal);
      if (!(result.normal.norm() > 0.))
        result.normal = towards / result.distance;
      result.normal /= result.normal.norm();
      return result;
    }
  } // namespace



  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(const std::string &formula, const std::string &parameter)
  {
    return std::make_unique<ClosestOfShape<dim>>(formula, parameter);
  }



  template std::unique_ptr<ClosestSurface<2>>
  make_closest_surface(const std::string &, const std::string &);
  template std::unique_ptr<ClosestSurface<3>>
  make_closest_surface(const std::string &, const std::string &);
} // namespace greville

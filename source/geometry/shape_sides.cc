// SPDX-License-Identifier: LGPL-2.1-or-later

#include "closest_shape.h"
#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace internal
  {
    namespace
    {
      // Planes are the same up to this, and a point is on a level set: relative
      // to coordinates.
      constexpr double same_place_of_sides = 1e-13;

      // Of boxes that are cut into parts to find the extent of a shape.
      constexpr unsigned int most_boxes = 100000;



      /**
       * The formula, with the numbers of arguments that ShapeTree relies on.
       */
      template <int dim>
      const std::string &
      checked(const std::string &formula, const std::string &parameter)
      {
        const Shape<dim> shape(formula, parameter);
        return formula;
      }
    } // namespace



    template <int dim>
    SidesOfShape<dim>::SidesOfShape(const std::string &formula,
                                    const std::string &parameter)
      : tree(checked<dim>(formula, parameter), parameter)
    {
      const auto &all = tree.level_sets();
      sides.assign(all.size(), ShapeTree<dim>::outside);
      active.assign(all.size(), false);
      for (const LevelSet<dim> &level_set : all)
        {
          has_formulas =
            has_formulas || level_set.kind == LevelSet<dim>::formula;
          length = std::max({length,
                             std::abs(level_set.as_plane.offset),
                             level_set.radius,
                             level_set.center.norm()});
        }
      for (unsigned int k = 0; k < all.size(); ++k)
        {
          const Plane<dim> &plane   = all[k].as_plane;
          bool              is_copy = false;
          for (const unsigned int other : numbers)
            if (all[k].kind == LevelSet<dim>::plane &&
                all[other].kind == LevelSet<dim>::plane && !is_copy)
              {
                const Plane<dim> &original = all[other].as_plane;
                const double      side =
                  plane.normal * original.normal < 0. ? -1. : 1.;
                if ((plane.normal - side * original.normal).norm() <
                      same_place_of_sides &&
                    std::abs(plane.offset - side * original.offset) <
                      same_place_of_sides * length)
                  {
                    is_copy = true;
                    copies.push_back({k, other, side < 0.});
                  }
              }
          if (!is_copy)
            numbers.push_back(k);
        }
    }



    template <int dim>
    typename ShapeTree<dim>::Side
    SidesOfShape<dim>::evaluate() const
    {
      for (const Copy &copy : copies)
        sides[copy.number] =
          Side(copy.is_inverted ? -sides[copy.original] : sides[copy.original]);
      return tree.evaluate(sides, active);
    }



    template <int dim>
    bool
    SidesOfShape<dim>::is_inside(const Point<dim> &x) const
    {
      for (const unsigned int k : numbers)
        sides[k] = level_sets()[k].value(x) <= 0. ? ShapeTree<dim>::inside
                                                  : ShapeTree<dim>::outside;
      return evaluate() == ShapeTree<dim>::inside;
    }



    template <int dim>
    bool
    SidesOfShape<dim>::is_outside(const BoundingBox<dim> &box) const
    {
      for (const unsigned int k : numbers)
        {
          const LevelSet<dim> &level_set = level_sets()[k];
          sides[k]                       = ShapeTree<dim>::unknown;
          double least = 0., largest = 0.;
          if (level_set.kind == LevelSet<dim>::plane)
            {
              least = largest = -level_set.as_plane.offset;
              for (unsigned int d = 0; d < dim; ++d)
                {
                  const double normal = level_set.as_plane.normal[d];
                  // Bounds may be infinite.
                  if (normal == 0.)
                    continue;
                  const bool is_up = normal > 0.;
                  least +=
                    normal * (is_up ? box.lower_bound(d) : box.upper_bound(d));
                  largest +=
                    normal * (is_up ? box.upper_bound(d) : box.lower_bound(d));
                }
            }
          else if (level_set.kind == LevelSet<dim>::quadric)
            {
              // The distance along axes for balls and cylinders along them.
              double nearest = 0., furthest = 0., radius = 0.;
              bool   is_diagonal = true;
              for (unsigned int d = 0; d < dim; ++d)
                {
                  const double a = box.lower_bound(d) - level_set.center[d];
                  const double b = box.upper_bound(d) - level_set.center[d];
                  const double weight = level_set.metric[d][d];
                  if (weight > 0.)
                    {
                      nearest += weight * std::pow(std::max({a, -b, 0.}), 2);
                      furthest += weight * std::max(a * a, b * b);
                    }
                  radius += std::pow(0.5 * box.side_length(d), 2);
                  for (unsigned int e = 0; e < d; ++e)
                    is_diagonal =
                      is_diagonal && std::abs(level_set.metric[d][e]) < 1e-15;
                }
              nearest  = std::sqrt(nearest);
              furthest = std::sqrt(furthest);
              if (!is_diagonal && !std::isfinite(radius))
                continue;
              if (!is_diagonal)
                {
                  const auto   out = box.center() - level_set.center;
                  const double distance =
                    std::sqrt(std::max(0., out * (level_set.metric * out)));
                  nearest  = distance - std::sqrt(radius);
                  furthest = distance + std::sqrt(radius);
                }
              least   = nearest - level_set.radius;
              largest = furthest - level_set.radius;
            }
          else
            continue;
          if (least >= 0.)
            sides[k] = ShapeTree<dim>::outside;
          else if (largest <= 0.)
            sides[k] = ShapeTree<dim>::inside;
        }
      return evaluate() == ShapeTree<dim>::outside;
    }



    template <int dim>
    bool
    SidesOfShape<dim>::is_on_surface(const Point<dim>                    &y,
                                     const std::array<unsigned int, dim> &given,
                                     const unsigned int                   n,
                                     const double    differences,
                                     Tensor<1, dim> *normals) const
    {
      std::array<Tensor<1, dim>, max_planes> gradients;
      std::array<unsigned int, max_planes>   at_zero;
      unsigned int                           n_at_zero = 0;
      const double tolerance = same_place_of_sides * (length + y.norm());
      for (const unsigned int k : numbers)
        {
          const LevelSet<dim> &level_set = level_sets()[k];
          const bool           is_given =
            std::find(given.begin(), given.begin() + n, k) != given.begin() + n;
          const double value = is_given ? 0. : level_set.value(y);
          sides[k] =
            value <= 0. ? ShapeTree<dim>::inside : ShapeTree<dim>::outside;
          if (level_set.kind != LevelSet<dim>::formula &&
              std::abs(value) > tolerance)
            continue;
          const Tensor<1, dim> gradient =
            derivatives(level_set, y, differences, false).gradient;
          const double norm = gradient.norm();
          if (!(norm > 0.) || std::abs(value) > tolerance * norm ||
              n_at_zero == max_planes)
            continue;
          gradients[n_at_zero] = gradient / norm;
          at_zero[n_at_zero++] = k;
        }
      bool       found[2] = {false, false};
      const auto visit    = [&]() {
        const Side side                               = evaluate();
        found[side == ShapeTree<dim>::inside ? 0 : 1] = true;
        if (normals)
          for (unsigned int i = 0; i < n_at_zero; ++i)
            {
              Side &own = sides[at_zero[i]];
              own       = Side(-own);
              if (evaluate() != side)
                *normals += (own == side ? -1. : 1.) * gradients[i];
              own = Side(-own);
            }
        return found[0] && found[1] && !normals;
      };
      // All sides are possible where gradients are linearly independent.
      double volume = 0.;
      if constexpr (dim == 2)
        volume =
          n_at_zero == 2 ? gradients[0] * cross_product_2d(gradients[1]) : 0.;
      else if (n_at_zero == 2)
        volume = cross_product_3d(gradients[0], gradients[1]).norm();
      else if (n_at_zero == 3)
        volume = gradients[0] * cross_product_3d(gradients[1], gradients[2]);
      if (n_at_zero == 1 || std::abs(volume) > 1e-6)
        for (unsigned int s = 0; s < (1u << n_at_zero); ++s)
          {
            for (unsigned int i = 0; i < n_at_zero; ++i)
              sides[at_zero[i]] =
                (s >> i) & 1 ? ShapeTree<dim>::outside : ShapeTree<dim>::inside;
            if (visit())
              break;
          }
      else if (n_at_zero > 0)
        visit_sectors(gradients,
                      n_at_zero,
                      [&](const Tensor<1, dim> &direction) {
                        for (unsigned int i = 0; i < n_at_zero; ++i)
                          sides[at_zero[i]] = gradients[i] * direction < 0.
                                                ? ShapeTree<dim>::inside
                                                : ShapeTree<dim>::outside;
                        return visit();
                      });
      return found[0] && found[1];
    }



    template <int dim>
    void
    SidesOfShape<dim>::add_to_hull(const BoundingBox<dim> &box,
                                   const unsigned int      depth,
                                   unsigned int           &n_boxes,
                                   Point<dim>             &lower,
                                   Point<dim>             &upper) const
    {
      bool is_within = true;
      for (unsigned int d = 0; d < dim; ++d)
        is_within = is_within && box.lower_bound(d) >= lower[d] &&
                    box.upper_bound(d) <= upper[d];
      if (is_within || ++n_boxes > most_boxes || is_outside(box))
        return;
      if (depth > 0)
        for (unsigned int k = 0; k < (1u << dim); ++k)
          {
            Point<dim> low = box.center(), high = box.vertex(k);
            for (unsigned int d = 0; d < dim; ++d)
              if (low[d] > high[d])
                std::swap(low[d], high[d]);
            add_to_hull(
              BoundingBox<dim>({low, high}), depth - 1, n_boxes, lower, upper);
          }
      else
        for (unsigned int d = 0; d < dim; ++d)
          {
            lower[d] = std::min(lower[d], box.lower_bound(d));
            upper[d] = std::max(upper[d], box.upper_bound(d));
          }
    }



    template <int dim>
    BoundingBox<dim>
    SidesOfShape<dim>::box() const
    {
      const double infinity = std::numeric_limits<double>::infinity();
      const double largest  = 64. * (length > 0. ? length : 1.);
      Point<dim>   lower, upper;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] = -largest;
          upper[d] = largest;
        }
      // The first pass finds the size, each of the others the extent up to a
      // hundredth of the one before.
      bool is_known = false;
      for (unsigned int pass = 0; pass < 4; ++pass)
        {
          Point<dim>   low, high;
          unsigned int n_boxes = 0;
          for (unsigned int d = 0; d < dim; ++d)
            {
              low[d]  = infinity;
              high[d] = -infinity;
            }
          add_to_hull(BoundingBox<dim>({lower, upper}),
                      pass == 0 ? 11 : 7,
                      n_boxes,
                      low,
                      high);
          if (n_boxes > most_boxes || low[0] > high[0])
            break;
          is_known = true;
          lower    = low;
          upper    = high;
        }
      // A body without end in one direction may end in another one only behind
      // what was looked at.
      for (unsigned int d = 0; d < dim; ++d)
        is_known = is_known && lower[d] > -largest && upper[d] < largest;
      if (!is_known)
        for (unsigned int d = 0; d < dim; ++d)
          {
            lower[d] = -infinity;
            upper[d] = infinity;
          }
      // Balls, cylinders and planes along axes end exactly where they end.
      for (unsigned int d = 0; d < dim; ++d)
        for (const int side : {-1, 1})
          for (const unsigned int k : numbers)
            for (const int end : {-1, 1})
              {
                const LevelSet<dim> &level_set = level_sets()[k];
                if (level_set.kind == LevelSet<dim>::formula)
                  continue;
                const double at =
                  level_set.kind == LevelSet<dim>::plane
                    ? level_set.as_plane.offset * level_set.as_plane.normal[d]
                    : level_set.center[d] + end * level_set.radius;
                if (at <= lower[d] || at >= upper[d])
                  continue;
                Point<dim> low = lower, high = upper;
                (side < 0 ? high : low)[d] = at;
                if (is_outside(BoundingBox<dim>({low, high})))
                  (side < 0 ? lower : upper)[d] = at;
              }
      return BoundingBox<dim>({lower, upper});
    }



    template class SidesOfShape<2>;
    template class SidesOfShape<3>;
  } // namespace internal
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/function_restriction.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/hp/q_collection.h>
#include <deal.II/non_matching/quadrature_generator.h>

#include <greville/geometry/fitted_shape.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Positions coincide if they are closer than this fraction of a cell.
    constexpr double same_place = 1e-11;

    // The number of bisections of a cell in which curved surfaces meet others.
    // Each bisection reduces the error of the last planes by a factor of 8.
    template <int dim>
    constexpr unsigned int max_depth = dim == 2 ? 12 : 4;

    // If a surface turns by more than this in a part, additional errors appear,
    // and the part is bisected, up to the given number of times.
    constexpr double flat_enough = 0.3;

    template <int dim>
    constexpr unsigned int max_curved_depth = dim == 2 ? 2 : 1;

    // The number of bisections by deal.II if the surface in a part is not a
    // height function along an axis. After them, deal.II uses a single point.
    constexpr unsigned int max_box_splits = 10;



    template <int dim>
    class CellCutter
    {
    public:
      using Side  = typename ShapeTree<dim>::Side;
      using Sides = std::vector<Side>;

      CellCutter(const ShapeTree<dim> &tree,
                 const Point<dim>     &corner,
                 const Tensor<1, dim> &size,
                 const unsigned int    n)
        : tree(tree)
        , n(n)
        , quadrature(n)
        , rules(QGauss<1>(n))
      {
        for (const auto &level_set : tree.level_sets())
          level_sets.emplace_back(level_set, corner, size);
      }

      CellPart<dim>
      cut()
      {
        const auto cell = create_unit_bounding_box<dim>();
        Sides      sides(level_sets.size(), ShapeTree<dim>::unknown);
        find_sides(cell, sides);
        std::vector<bool> active(level_sets.size(), false);
        const Side        side = tree.evaluate(sides, active);
        if (side == ShapeTree<dim>::inside)
          part.is_full = true;
        else if (side == ShapeTree<dim>::unknown)
          {
            cut_box(cell, sides, 0);
            double volume = 0.;
            for (const auto &point : part.points)
              volume += point.weight;
            if (volume > 1. - 1e-12)
              {
                part.is_full = true;
                part.points.clear();
              }
          }
        // Add the boundary on planes that coincide with faces of the cell.
        if (side != ShapeTree<dim>::outside)
          for (unsigned int j = 0; j < level_sets.size(); ++j)
            if (const unsigned int d = level_sets[j].axis(); d < dim)
              for (const double face : {0., 1.})
                {
                  Point<dim> on_face;
                  on_face[d] = face;
                  if (std::abs(level_sets[j].value(on_face)) <
                      level_sets[j].gradient(on_face).norm() * same_place)
                    {
                      auto  ends = cell.get_boundary_points();
                      Sides others(level_sets.size(), ShapeTree<dim>::unknown);
                      ends.first[d] = ends.second[d] = face;
                      cut_flat_box(
                        BoundingBox<dim>(ends), d, j, sides[j], others, 0);
                    }
                }
        return part;
      }

    private:
      /// Set the sides of the level sets that do not cut a box.
      void
      find_sides(const BoundingBox<dim> &box, Sides &sides) const
      {
        for (unsigned int j = 0; j < sides.size(); ++j)
          if (sides[j] == ShapeTree<dim>::unknown)
            sides[j] = Side(level_sets[j].sign(box));
      }



      /// If level set @p j is an axis-aligned plane, cut a box by it. Return
      /// whether it is.
      bool
      cut_along_axes(const unsigned int      j,
                     const BoundingBox<dim> &box,
                     BoundingBox<dim>       &below,
                     BoundingBox<dim>       &above) const
      {
        const unsigned int d = level_sets[j].axis();
        if (d == dim)
          return false;
        auto         low = box.get_boundary_points(), high = low;
        const double slope = level_sets[j].gradient(low.first)[d];
        const double x = low.first[d] - level_sets[j].value(low.first) / slope;
        low.second[d] = high.first[d] = x;
        below                         = BoundingBox<dim>(low);
        above                         = BoundingBox<dim>(high);
        return true;
      }



      /// Return parts of half the size in each direction.
      static std::vector<BoundingBox<dim>>
      halves(const BoundingBox<dim> &box)
      {
        std::vector<BoundingBox<dim>> result = {box};
        for (unsigned int d = 0; d < dim; ++d)
          if (box.side_length(d) > 0.)
            {
              std::vector<BoundingBox<dim>> parts;
              for (const auto &part : result)
                {
                  auto low = part.get_boundary_points(), high = low;
                  low.second[d] = high.first[d] =
                    0.5 * (low.first[d] + low.second[d]);
                  parts.emplace_back(low);
                  parts.emplace_back(high);
                }
              result = parts;
            }
        return result;
      }



      /// The level sets that cut a box: their number and kind.
      struct Active
      {
        Active(const std::vector<bool>              &active,
               const std::vector<CellLevelSet<dim>> &level_sets)
        {
          for (unsigned int j = 0; j < active.size(); ++j)
            if (active[j])
              {
                all.push_back(j);
                has_curved =
                  has_curved || level_sets[j].kind() != LevelSet<dim>::plane;
              }
        }

        std::vector<unsigned int> all;
        bool                      has_curved = false;
      };



      void
      cut_box(const BoundingBox<dim> &box,
              Sides                   sides,
              const unsigned int      depth)
      {
        find_sides(box, sides);
        std::vector<bool> is_active(level_sets.size(), false);
        const Side        side = tree.evaluate(sides, is_active);
        if (side == ShapeTree<dim>::inside)
          {
            const auto &corner = box.get_boundary_points().first;
            for (unsigned int q = 0; q < quadrature.size(); ++q)
              {
                Point<dim> x = corner;
                for (unsigned int d = 0; d < dim; ++d)
                  x[d] += box.side_length(d) * quadrature.point(q)[d];
                part.points.push_back({x, quadrature.weight(q) * box.volume()});
              }
          }
        if (side != ShapeTree<dim>::unknown)
          return;

        BoundingBox<dim> below, above;
        const Active     active(is_active, level_sets);
        for (const unsigned int j : active.all)
          if (cut_along_axes(j, box, below, above))
            {
              Sides others = sides;
              cut_flat_box(BoundingBox<dim>(
                             {above.get_boundary_points().first,
                              below.get_boundary_points().second}),
                           level_sets[j].axis(),
                           j,
                           ShapeTree<dim>::unknown,
                           others,
                           depth);
              sides[j] = ShapeTree<dim>::inside;
              cut_box(below, sides, depth);
              sides[j] = ShapeTree<dim>::outside;
              cut_box(above, sides, depth);
              return;
            }
        if (active.has_curved && active.all.size() == 1 &&
            (depth >= max_curved_depth<dim> ||
             level_sets[active.all[0]].flatness(box) > flat_enough))
          cut_by_surface(box, active.all[0], sides);
        else if (active.has_curved && depth < max_depth<dim>)
          for (const auto &half : halves(box))
            cut_box(half, sides, depth + 1);
        else
          {
            planes.assign(level_sets.size(), Plane<dim>());
            for (const unsigned int j : active.all)
              planes[j] = level_sets[j].tangent_plane(box.center());
            const ConvexPart<dim> whole(box);
            for (const unsigned int j : active.all)
              {
                ConvexPart<dim> low, high;
                Facet<dim>      cut;
                if (whole.split(planes[j], same_place, low, high, cut))
                  cut_facet(cut, j, ShapeTree<dim>::unknown, sides);
              }
            cut_convex_part(whole, sides);
          }
      }



      /// Integrate over a box that a single curved surface cuts.
      void
      cut_by_surface(const BoundingBox<dim> &box,
                     const unsigned int      j,
                     Sides                   sides)
      {
        NonMatching::QuadratureGenerator<dim> generator(rules,
                                                        {max_box_splits});
        generator.generate(level_sets[j], box);
        std::vector<bool> unused(level_sets.size(), false);
        sides[j]              = ShapeTree<dim>::inside;
        const bool  is_inside = tree.evaluate(sides, unused) == sides[j];
        const auto &points    = is_inside ? generator.get_inside_quadrature()
                                          : generator.get_outside_quadrature();
        for (unsigned int q = 0; q < points.size(); ++q)
          part.points.push_back({points.point(q), points.weight(q)});
        const auto &surface = generator.get_surface_quadrature();
        for (unsigned int q = 0; q < surface.size(); ++q)
          {
            auto normal = level_sets[j].gradient(surface.point(q));
            normal /= is_inside ? normal.norm() : -normal.norm();
            part.surface.push_back(
              {surface.point(q), normal, surface.weight(q)});
          }
      }



      /// Integrate over a part of a box between planes.
      void
      cut_convex_part(const ConvexPart<dim> &whole, Sides sides)
      {
        while (true)
          {
            std::vector<bool> is_active(level_sets.size(), false);
            const Side        side = tree.evaluate(sides, is_active);
            if (side == ShapeTree<dim>::inside)
              whole.append_quadrature(n, part.points);
            if (side != ShapeTree<dim>::unknown)
              return;
            const unsigned int j = first_of(is_active);
            ConvexPart<dim>    low, high;
            Facet<dim>         cut;
            if (whole.split(planes[j], same_place, low, high, cut))
              {
                sides[j] = ShapeTree<dim>::inside;
                cut_convex_part(low, sides);
                sides[j] = ShapeTree<dim>::outside;
                cut_convex_part(high, sides);
                return;
              }
            sides[j] = side_of(planes[j].distance(whole.center()));
          }
      }



      static unsigned int
      first_of(const std::vector<bool> &is_active)
      {
        return std::find(is_active.begin(), is_active.end(), true) -
               is_active.begin();
      }

      static Side
      side_of(const double value)
      {
        return value < 0. ? ShapeTree<dim>::inside : ShapeTree<dim>::outside;
      }



      /// Return whether the boundary of the shape is the zero set of level set
      /// @p j: 1 if the shape is on its inner side, -1 if it is on its outer
      /// side, 0 if it is on both or none. If this is unknown, the result is
      /// empty, and depends on the @p active level sets.
      std::optional<int>
      boundary(const unsigned int j,
               Sides              sides,
               std::vector<bool> &active) const
      {
        sides[j]         = ShapeTree<dim>::inside;
        const Side inner = tree.evaluate(sides, active);
        sides[j]         = ShapeTree<dim>::outside;
        const Side outer = tree.evaluate(sides, active);
        if (inner == ShapeTree<dim>::unknown ||
            outer == ShapeTree<dim>::unknown)
          return {};
        return (outer - inner) / 2;
      }

      /// Return the normal of the boundary in @p plane of level set @p j. It is
      /// zero if there is no boundary, or if the shape is not on the side
      /// @p wanted of the plane.
      static Tensor<1, dim>
      normal_of(const int sign, const Side wanted, const Plane<dim> &plane)
      {
        return (wanted == ShapeTree<dim>::unknown || sign == -wanted ? sign
                                                                     : 0) *
               plane.normal;
      }



      /// Integrate over the boundary in a part of plane @p j.
      void
      cut_facet(const Facet<dim>  &facet,
                const unsigned int j,
                const Side         wanted,
                Sides              sides)
      {
        while (true)
          {
            std::vector<bool> is_active(level_sets.size(), false);
            const auto        sign = boundary(j, sides, is_active);
            if (sign.has_value())
              {
                const auto normal = normal_of(*sign, wanted, planes[j]);
                if (normal.norm_square() > 0.)
                  append_quadrature(facet, normal, n, part.surface);
                return;
              }
            const unsigned int k = first_of(is_active);
            Facet<dim>         low, high;
            split_facet(facet, planes[k], same_place, low, high);
            if (low.size() >= dim && high.size() >= dim)
              {
                sides[k] = ShapeTree<dim>::inside;
                cut_facet(low, j, wanted, sides);
                sides[k] = ShapeTree<dim>::outside;
                cut_facet(high, j, wanted, sides);
                return;
              }
            sides[k] = side_of(planes[k].distance(center_of<dim>(facet)));
          }
      }



      /// Integrate over the boundary in a box of the axis-aligned plane @p j,
      /// across direction @p d.
      void
      cut_flat_box(const BoundingBox<dim> &box,
                   const unsigned int      d,
                   const unsigned int      j,
                   const Side              wanted,
                   Sides                   sides,
                   const unsigned int      depth)
      {
        find_sides(box, sides);
        std::vector<bool> is_active(level_sets.size(), false);
        const auto        sign  = boundary(j, sides, is_active);
        const Plane<dim>  plane = level_sets[j].tangent_plane(box.center());
        const BoundingBox<dim - 1> face  = box.cross_section(d);
        const double               place = box.lower_bound(d);
        const auto                 add   = [&](const Quadrature<dim - 1> &rule,
                             const Sides               &all) {
          const auto value = boundary(j, all, is_active);
          const auto normal = normal_of(value ? *value : 0, wanted, plane);
          if (normal.norm_square() > 0.)
            for (unsigned int q = 0; q < rule.size(); ++q)
              part.surface.push_back(
                {internal::create_higher_dim_point(rule.point(q), d, place),
                 normal,
                 rule.weight(q)});
        };
        if (sign.has_value())
          {
            const QGauss<dim - 1>       unit(n);
            std::vector<Point<dim - 1>> points;
            std::vector<double>         weights;
            for (unsigned int q = 0; q < unit.size(); ++q)
              {
                points.push_back(face.unit_to_real(unit.point(q)));
                weights.push_back(unit.weight(q) * face.volume());
              }
            add(Quadrature<dim - 1>(points, weights), sides);
            return;
          }

        BoundingBox<dim> below, above;
        is_active[j] = false;
        const Active active(is_active, level_sets);
        for (const unsigned int k : active.all)
          if (cut_along_axes(k, box, below, above))
            {
              sides[k] = ShapeTree<dim>::inside;
              cut_flat_box(below, d, j, wanted, sides, depth);
              sides[k] = ShapeTree<dim>::outside;
              cut_flat_box(above, d, j, wanted, sides, depth);
              return;
            }
        if (!active.has_curved)
          {
            planes.assign(level_sets.size(), Plane<dim>());
            planes[j] = plane;
            for (const unsigned int k : active.all)
              planes[k] = level_sets[k].tangent_plane(box.center());
            Facet<dim> facet;
            for (const unsigned int k : {0, 1, 3, 2})
              if (k < (1 << (dim - 1)))
                facet.push_back(
                  internal::create_higher_dim_point(face.vertex(k), d, place));
            cut_facet(facet, j, wanted, sides);
          }
        else if (active.all.size() == 1)
          {
            const unsigned int                              k = active.all[0];
            const Functions::CoordinateRestriction<dim - 1> restriction(
              level_sets[k], d, place);
            NonMatching::QuadratureGenerator<dim - 1> generator(
              rules, {max_box_splits});
            generator.generate(restriction, face);
            sides[k] = ShapeTree<dim>::inside;
            add(generator.get_inside_quadrature(), sides);
            sides[k] = ShapeTree<dim>::outside;
            add(generator.get_outside_quadrature(), sides);
          }
        else if (depth < max_depth<2>)
          for (const auto &half : halves(box))
            cut_flat_box(half, d, j, wanted, sides, depth + 1);
        else
          {
            for (const unsigned int k : active.all)
              sides[k] = side_of(level_sets[k].value(box.center()));
            add(Quadrature<dim - 1>(std::vector<Point<dim - 1>>(1,
                                                                face.center()),
                                    std::vector<double>(1, face.volume())),
                sides);
          }
      }



      const ShapeTree<dim>          &tree;
      const unsigned int             n;
      const QGauss<dim>              quadrature;
      const hp::QCollection<1>       rules; // generators point to it
      std::vector<CellLevelSet<dim>> level_sets;
      std::vector<Plane<dim>>        planes;
      CellPart<dim>                  part;
    };
  } // namespace



  template <int dim>
  LevelSetShape<dim>::LevelSetShape(const std::string &formula,
                                    const std::string &parameter)
    : shape(formula, parameter)
    , tree(formula, parameter)
  {}



  template <int dim>
  CellPart<dim>
  LevelSetShape<dim>::cut(const CellBox<dim> &cell, const unsigned int n) const
  {
    return CellCutter<dim>(tree, cell.lower, cell.size, n).cut();
  }



  GREVILLE_INSTANTIATE_CLASS(LevelSetShape);
} // namespace greville

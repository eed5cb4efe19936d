// SPDX-License-Identifier: LGPL-2.1-or-later

#include "shape_edges.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace internal
  {
    namespace
    {
      // Angles (rad) and relative distances below this are zero.
      constexpr double no_angle = 1e-12;

      // Of a curve, around a cylinder.
      constexpr unsigned int n_samples = 192;



      template <int dim>
      bool
      is_cylinder(const LevelSet<dim> &level_set)
      {
        return level_set.kind == LevelSet<dim>::quadric &&
               trace(level_set.metric) < dim - 0.5;
      }

      template <int dim>
      bool
      is_ball(const LevelSet<dim> &level_set)
      {
        return level_set.kind == LevelSet<dim>::quadric &&
               !is_cylinder(level_set);
      }



      /**
       * The axis of a cylinder: its metric is I - a a^T.
       */
      Tensor<1, 3>
      axis_of(const LevelSet<3> &cylinder)
      {
        unsigned int d = 0;
        for (unsigned int e = 1; e < 3; ++e)
          if (cylinder.metric[e][e] < cylinder.metric[d][d])
            d = e;
        Tensor<1, 3> axis;
        for (unsigned int e = 0; e < 3; ++e)
          axis[e] = (d == e ? 1. : 0.) - cylinder.metric[d][e];
        return axis / axis.norm();
      }



      Tensor<1, 3>
      orthogonal_to(const Tensor<1, 3> &direction)
      {
        unsigned int d = 0;
        for (unsigned int e = 1; e < 3; ++e)
          if (std::abs(direction[e]) < std::abs(direction[d]))
            d = e;
        Tensor<1, 3> axis;
        axis[d] = 1.;
        axis    = cross_product_3d(direction, axis);
        return axis / axis.norm();
      }



      /**
       * The plane in which two balls meet.
       */
      template <int dim>
      Plane<dim>
      radical_plane(const LevelSet<dim> &a, const LevelSet<dim> &b)
      {
        Plane<dim>   plane;
        const auto   apart    = b.center - a.center;
        const double distance = apart.norm();
        plane.normal          = apart / distance;
        plane.offset          = plane.normal * a.center +
                       0.5 * (distance + (a.radius - b.radius) *
                                           (a.radius + b.radius) / distance);
        return plane;
      }



      void
      add_circle(Edge                edge,
                 const Point<3>     &center,
                 const Tensor<1, 3> &direction,
                 const double        square_radius,
                 std::vector<Edge>  &edges)
      {
        if (!(square_radius > 0.))
          return;
        edge.kind        = Edge::circle;
        edge.center      = center;
        edge.direction   = direction;
        edge.across      = orthogonal_to(direction);
        edge.radius      = std::sqrt(square_radius);
        const auto other = cross_product_3d(edge.direction, edge.across);
        for (unsigned int k = 0; k < n_samples; ++k)
          {
            const double angle = 2. * numbers::PI * k / n_samples;
            edge.samples.push_back(
              {edge.center + edge.radius * (std::cos(angle) * edge.across +
                                            std::sin(angle) * other),
               true});
          }
        edges.push_back(edge);
      }



      /**
       * The lines in which a cylinder meets a plane along its axis.
       */
      void
      add_lines(Edge               edge,
                const LevelSet<3> &cylinder,
                const Plane<3>    &plane,
                std::vector<Edge> &edges)
      {
        const double distance = plane.distance(cylinder.center);
        const double square =
          (cylinder.radius - distance) * (cylinder.radius + distance);
        if (!(square > 0.))
          return;
        edge.kind           = Edge::line;
        edge.direction      = axis_of(cylinder);
        const auto sideways = cross_product_3d(plane.normal, edge.direction);
        for (const int side : {-1, 1})
          {
            edge.center = cylinder.center - distance * plane.normal +
                          side * std::sqrt(square) * sideways;
            edges.push_back(edge);
          }
      }



      /**
       * The curve in which a cylinder meets another level set, from samples
       * around the cylinder.
       */
      void
      add_curve(Edge               edge,
                const LevelSet<3> &cylinder,
                const LevelSet<3> &other,
                std::vector<Edge> &edges)
      {
        edge.kind       = Edge::curve;
        const auto axis = axis_of(cylinder);
        // Samples lie where the other one is nearest.
        Tensor<1, 3> u;
        if (is_cylinder(other))
          {
            u = cross_product_3d(axis, axis_of(other));
            if (u * (other.center - cylinder.center) < 0.)
              u = -u;
          }
        else if (is_ball(other))
          u = cylinder.metric * (other.center - cylinder.center);
        if (!(u.norm() > 1e-9 * cylinder.radius))
          u = orthogonal_to(axis);
        u /= u.norm();
        const auto v      = cross_product_3d(axis, u);
        bool       exists = false;
        for (const int branch : {-1, 1})
          {
            for (unsigned int k = 0; k < n_samples; ++k)
              {
                const double   angle = 2. * numbers::PI * k / n_samples;
                const Point<3> x =
                  cylinder.center +
                  cylinder.radius * (std::cos(angle) * u + std::sin(angle) * v);
                // a t^2 + 2 b t + c = 0 for x + t axis.
                double t         = 0.;
                bool   is_common = true;
                if (other.kind == LevelSet<3>::plane)
                  t = -other.as_plane.distance(x) /
                      (other.as_plane.normal * axis);
                else
                  {
                    const auto   along = other.metric * axis;
                    const double a     = along * axis;
                    const double b     = along * (x - other.center);
                    const double c     = 2. * other.radius * other.value(x);
                    const double root  = b * b - a * c;
                    is_common          = root >= 0.;
                    if (is_common)
                      t = (-b + branch * std::sqrt(root)) / a;
                  }
                edge.samples.push_back({x + t * axis, is_common});
                exists = exists || is_common;
              }
            if (other.kind == LevelSet<3>::plane)
              break;
            edge.samples.push_back({Point<3>(), false});
          }
        if (exists)
          edges.push_back(edge);
      }



      void
      add_edges(const std::vector<LevelSet<3>> &level_sets,
                const unsigned int              i,
                const unsigned int              j,
                std::vector<Edge>              &edges)
      {
        const LevelSet<3> *a = &level_sets[i], *b = &level_sets[j];
        Edge               edge;
        edge.level_sets = {{i, j}};
        // Cylinders go first, then balls, then planes.
        const auto rank = [](const LevelSet<3> &level_set) {
          return is_cylinder(level_set) ? 2 : is_ball(level_set) ? 1 : 0;
        };
        if (rank(*a) < rank(*b))
          std::swap(a, b);
        const Plane<3> &plane = b->as_plane;
        if (rank(*a) == 0)
          {
            const auto along =
              cross_product_3d(a->as_plane.normal, plane.normal);
            const double sine = along.norm();
            if (sine < no_angle)
              return;
            edge.direction      = along / sine;
            const double cosine = a->as_plane.normal * plane.normal;
            edge.center         = Point<3>(
              ((a->as_plane.offset - cosine * plane.offset) *
                 a->as_plane.normal +
               (plane.offset - cosine * a->as_plane.offset) * plane.normal) /
              (sine * sine));
            edges.push_back(edge);
          }
        else if (rank(*a) == 1)
          {
            const bool is_plane = rank(*b) == 0;
            if (!is_plane && !(a->center.distance(b->center) > 0.))
              return;
            const Plane<3> common   = is_plane ? plane : radical_plane(*a, *b);
            const double   distance = common.distance(a->center);
            add_circle(edge,
                       a->center - distance * common.normal,
                       common.normal,
                       (a->radius - distance) * (a->radius + distance),
                       edges);
          }
        else if (rank(*b) == 0)
          {
            const auto   axis   = axis_of(*a);
            const double cosine = std::abs(axis * plane.normal);
            if (cross_product_3d(axis, plane.normal).norm() < no_angle)
              add_circle(edge,
                         a->center - plane.distance(a->center) /
                                       (plane.normal * axis) * axis,
                         axis,
                         a->radius * a->radius,
                         edges);
            else if (cosine < no_angle)
              add_lines(edge, *a, plane, edges);
            else
              add_curve(edge, *a, *b, edges);
          }
        else if (rank(*b) == 2 &&
                 cross_product_3d(axis_of(*a), axis_of(*b)).norm() < no_angle)
          {
            // Axes are parallel.
            LevelSet<3> other = *b;
            other.center =
              a->center + Tensor<1, 3>(a->metric * (b->center - a->center));
            if (a->center.distance(other.center) > 0.)
              add_lines(edge, *a, radical_plane(*a, other), edges);
          }
        else
          add_curve(edge, *a, *b, edges);
      }



      /**
       * Where a line meets a level set.
       */
      template <int dim>
      void
      add_points(const Point<dim>        &center,
                 const Tensor<1, dim>    &direction,
                 const LevelSet<dim>     &other,
                 std::vector<Point<dim>> &points)
      {
        if (other.kind == LevelSet<dim>::plane)
          {
            const double slope = direction * other.as_plane.normal;
            if (std::abs(slope) > no_angle)
              points.push_back(center - other.as_plane.distance(center) /
                                          slope * direction);
            return;
          }
        const Tensor<1, dim> along = other.metric * direction;
        const double         a     = along * direction;
        if (a < no_angle * no_angle)
          return;
        // From the point of the line that is nearest.
        const Point<dim> nearest =
          center - along * (center - other.center) / a * direction;
        const double square = -2. * other.radius * other.value(nearest) / a;
        if (square >= 0.)
          for (const int side : {-1, 1})
            points.push_back(nearest + side * std::sqrt(square) * direction);
      }



      /**
       * Add a corner near @p x, unless it is there.
       */
      template <int dim>
      void
      add_corner(const std::vector<LevelSet<dim>>    &all,
                 const std::array<unsigned int, dim> &numbers,
                 const double                         length,
                 Point<dim>                           x,
                 std::vector<Corner<dim>>            &corners)
      {
        std::array<const LevelSet<dim> *, dim> level_sets;
        for (unsigned int i = 0; i < dim; ++i)
          level_sets[i] = &all[numbers[i]];
        if (ConstrainedPoint<dim>(level_sets, dim, length).restore(x) &&
            std::none_of(
              corners.begin(), corners.end(), [&](const Corner<dim> &other) {
                return x.distance(other.x) < 1e-14 * (length + x.norm());
              }))
          corners.push_back({x, numbers});
      }
    } // namespace



    template <int dim>
    Point<dim>
    project(const LevelSet<dim> &level_set, const Point<dim> &x)
    {
      if (level_set.kind == LevelSet<dim>::plane)
        return x - level_set.as_plane.distance(x) * level_set.as_plane.normal;
      Tensor<1, dim> out      = level_set.metric * (x - level_set.center);
      const double   distance = out.norm();
      if (distance > 1e-14 * level_set.radius)
        return x + (level_set.radius / distance - 1.) * out;
      // On the axis all directions are alike.
      out = 0.;
      for (unsigned int d = 0; d < dim && !(out.norm() > 0.1); ++d)
        out = level_set.metric * Point<dim>::unit_vector(d);
      return x + level_set.radius / out.norm() * out;
    }



    std::vector<Edge>
    find_edges(const std::vector<LevelSet<3>>  &level_sets,
               const std::vector<unsigned int> &numbers,
               const double                     length)
    {
      std::vector<Edge> edges;
      for (const unsigned int i : numbers)
        for (const unsigned int j : numbers)
          if (i < j && level_sets[i].kind != LevelSet<3>::formula &&
              level_sets[j].kind != LevelSet<3>::formula)
            add_edges(level_sets, i, j, edges);
      // Planes at a small angle lose digits.
      for (Edge &edge : edges)
        if (edge.kind == Edge::line)
          ConstrainedPoint<3>({{&level_sets[edge.level_sets[0]],
                                &level_sets[edge.level_sets[1]],
                                nullptr}},
                              2,
                              length)
            .restore(edge.center);
      return edges;
    }



    std::vector<Corner<3>>
    find_corners(const std::vector<LevelSet<3>>  &level_sets,
                 const std::vector<unsigned int> &numbers,
                 const std::vector<Edge>         &edges,
                 const double                     length)
    {
      std::vector<Corner<3>> corners;
      std::vector<Point<3>>  points;
      for (const Edge &edge : edges)
        for (const unsigned int k : numbers)
          {
            const LevelSet<3> &other = level_sets[k];
            if (k <= edge.level_sets[1] || other.kind == LevelSet<3>::formula)
              continue;
            points.clear();
            if (edge.kind == Edge::line)
              add_points(edge.center, edge.direction, other, points);
            else
              {
                // Between samples on both sides, and where it is nearly zero.
                edge.visit_minima(
                  [&](const Point<3> &x) { return std::abs(other.value(x)); },
                  [&](const Point<3> &x) { points.push_back(x); });
                const auto &samples = edge.samples;
                for (std::size_t s = 0; s < samples.size(); ++s)
                  {
                    const auto &a = samples[s];
                    const auto &b = samples[(s + 1) % samples.size()];
                    if (!a.exists || !b.exists)
                      continue;
                    const double before = other.value(a.x);
                    const double after  = other.value(b.x);
                    if (before * after < 0.)
                      points.push_back(a.x +
                                       before / (before - after) * (b.x - a.x));
                  }
              }
            for (const Point<3> &x : points)
              add_corner<3>(level_sets,
                            {{edge.level_sets[0], edge.level_sets[1], k}},
                            length,
                            x,
                            corners);
          }
      return corners;
    }



    std::vector<Corner<2>>
    find_corners(const std::vector<LevelSet<2>>  &level_sets,
                 const std::vector<unsigned int> &numbers,
                 const double                     length)
    {
      std::vector<Corner<2>> corners;
      std::vector<Point<2>>  points;
      for (const unsigned int i : numbers)
        for (const unsigned int j : numbers)
          {
            const LevelSet<2> *a = &level_sets[i], *b = &level_sets[j];
            if (i >= j || a->kind == LevelSet<2>::formula ||
                b->kind == LevelSet<2>::formula)
              continue;
            if (b->kind == LevelSet<2>::plane)
              std::swap(a, b);
            Plane<2> plane = a->as_plane;
            if (a->kind != LevelSet<2>::plane)
              {
                if (!(a->center.distance(b->center) > 0.))
                  continue;
                plane = radical_plane(*a, *b);
              }
            points.clear();
            add_points(Point<2>(plane.offset * plane.normal),
                       Tensor<1, 2>(cross_product_2d(plane.normal)),
                       *b,
                       points);
            for (const Point<2> &x : points)
              add_corner<2>(level_sets, {{i, j}}, length, x, corners);
          }
      return corners;
    }



    template Point<2>
    project(const LevelSet<2> &, const Point<2> &);
    template Point<3>
    project(const LevelSet<3> &, const Point<3> &);
  } // namespace internal
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks closest points on surfaces of rigid bodies and signed distances, at
// random points, against closed forms and against all facets of meshes.

#include <greville/geometry/closest_surface.h>

#include <fstream>
#include <functional>
#include <random>
#include <tests.h>

constexpr double everywhere = std::numeric_limits<double>::infinity();

template <int dim>
using Distance = std::function<double(const Point<dim> &)>;

template <int dim>
std::unique_ptr<ClosestSurface<dim>>
from(const std::string &formula)
{
  return make_closest_surface<dim>(formula, "Body a/Shape");
}

template <int dim>
Distance<dim>
to_ball(const Point<dim> &center, const double radius)
{
  return [=](const Point<dim> &x) { return x.distance(center) - radius; };
}

template <int dim>
Distance<dim>
to_box(const Point<dim> &lower, const Point<dim> &upper)
{
  return [=](const Point<dim> &x) {
    double largest = -1e9, square = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double out = std::max(lower[d] - x[d], x[d] - upper[d]);
        largest          = std::max(largest, out);
        square += std::pow(std::max(out, 0.), 2);
      }
    return largest < 0. ? largest : std::sqrt(square);
  };
}



// Distances, which are also those between x and the closest point; normals as
// gradients of the distance where that is smooth; nothing where the surface is
// further away.
template <int dim>
void
check_surface(const std::string         &what,
              const ClosestSurface<dim> &surface,
              const Distance<dim>       &exact,
              const double               tolerance = 1e-12,
              const double               within    = everywhere)
{
  std::mt19937 generator(1); // the same numbers on all machines
  double       error = 0., gradient_error = 0.;
  unsigned int n_found = 0, n_smooth = 0, n_wrong = 0;
  for (unsigned int k = 0; k < 1000; ++k)
    {
      Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = 3. * (generator() / 4294967296.) - 1.;
      const double wanted = exact(x);
      const auto   found  = surface.closest(x, within);
      n_wrong += found.has_value() != (std::abs(wanted) < within);
      if (!found)
        continue;
      ++n_found;
      const double distance = found->distance;
      const auto   offset   = x - found->point - distance * found->normal;
      error                 = std::max({error,
                                        std::abs(distance - wanted),
                                        std::abs(exact(found->point)),
                                        offset.norm(),
                                        std::abs(found->normal.norm() - 1.)});
      n_wrong += surface.closest(x, 0.999999 * std::abs(distance)).has_value();
      Tensor<1, dim> gradient;
      bool is_smooth = std::abs(distance) > 1e-3 && std::abs(distance) < within;
      for (unsigned int d = 0; d < dim; ++d)
        for (const double step : {-1e-6, 1e-6})
          {
            const auto next =
              surface.closest(x + step * Point<dim>::unit_vector(d),
                              2. * within);
            gradient[d] += next->distance / (2. * step);
            is_smooth = is_smooth && next->point.distance(found->point) < 1e-3;
          }
      n_smooth += is_smooth;
      if (is_smooth)
        gradient_error =
          std::max(gradient_error, (gradient - found->normal).norm());
    }
  check(what + ": something and nothing", n_wrong, 0.);
  check(what + ": distance, point and normal", error, tolerance);
  check(what + ": gradient", gradient_error, 2e-5);
  check(what + ": gradients", n_smooth > 30 && n_smooth > 0.8 * n_found);
}



// From a ball of 0.8 around the origin without one of 0.6 around 0.9.
double
to_difference(const Point<2> &x)
{
  const Point<2> c(0.9, 0.), a(0.8 / x.norm() * x);
  const Point<2> b     = c + 0.6 / x.distance(c) * (x - c);
  const double   along = 0.5 * (0.64 - 0.36 + 0.81) / 0.9;
  double         least = Point<2>(x[0], std::abs(x[1]))
                   .distance(Point<2>(along, std::sqrt(0.64 - along * along)));
  if (a.distance(c) > 0.6)
    least = std::min(least, x.distance(a));
  if (b.norm() < 0.8)
    least = std::min(least, x.distance(b));
  return x.norm() < 0.8 && x.distance(c) > 0.6 ? -least : least;
}



void
test_shapes()
{
  check_surface<2>("disk",
                   *from<2>("ball(0.4, 0.6, 0.5)"),
                   to_ball(Point<2>(0.4, 0.6), 0.5));
  check_surface<3>("ball",
                   *from<3>("ball(0.4, 0.6, 0.3, 0.5)"),
                   to_ball(Point<3>(0.4, 0.6, 0.3), 0.5));
  const Tensor<1, 3> normal({2. / 3., -1. / 3., 2. / 3.});
  check_surface<3>("half space",
                   *from<3>("2 * x - y + 2 * z < 0.6"),
                   [&](const Point<3> &x) { return normal * x - 0.2; });

  const Point<2> low(0., 0.2), high(1., 0.9);
  const auto     box = from<2>("box(0, 0.2, 1, 0.9)");
  check_surface<2>("box in 2D", *box, to_box(low, high));
  const auto corner  = box->closest(Point<2>(1.3, 1.3), everywhere);
  const auto at_side = box->closest(Point<2>(1., 0.5), 1e-3);
  check("corner and side of a box",
        corner->point.distance(high) + std::abs(corner->distance - 0.5) +
          (corner->normal - Tensor<1, 2>({0.6, 0.8})).norm() +
          std::abs(at_side->distance) +
          (at_side->normal - Tensor<1, 2>({1., 0.})).norm(),
        1e-14);
  check_surface<3>("box in 3D",
                   *from<3>("box(0, 0.2, 0.1, 1, 0.9, 0.6)"),
                   to_box(Point<3>(0., 0.2, 0.1), Point<3>(1., 0.9, 0.6)));
  check_surface<2>(
    "no surface between parts",
    *from<2>("union(box(0, 0.2, 0.3, 0.9), box(0.1 + 0.2, 0.2, 1, 0.9))"),
    to_box(low, high));
  check_surface<2>("difference of disks",
                   *from<2>("difference(ball(0, 0, 0.8), ball(0.9, 0, 0.6))"),
                   to_difference,
                   1e-12,
                   0.4);
  check_surface<3>(
    "difference of balls",
    *from<3>("difference(ball(0.3, 0, 0, 0.8), ball(0.3, 0.9, 0, 0.6))"),
    [](const Point<3> &x) {
      return to_difference(Point<2>(x[1], std::hypot(x[0] - 0.3, x[2])));
    },
    1e-12,
    0.4);
  const Point<3>     begin(0.1, 0.3, 0.2), end(0.7, 1.1, 0.5);
  const double       length = begin.distance(end);
  const Tensor<1, 3> axis   = (end - begin) / length;
  const auto profile        = to_box(Point<2>(0., -0.4), Point<2>(length, 0.4));
  check_surface<3>("cylinder",
                   *from<3>("cylinder(0.1, 0.3, 0.2, 0.7, 1.1, 0.5, 0.4)"),
                   [&](const Point<3> &x) {
                     const double along = axis * (x - begin);
                     const auto   out   = x - begin - along * axis;
                     return profile(Point<2>(along, out.norm()));
                   });
}



// Formulas are the same as the shapes in their place.
template <int dim>
void
check_formula(const std::string &formula, const std::string &shape)
{
  const auto exact = from<dim>(shape);
  check_surface<dim>(
    formula,
    *from<dim>(formula),
    [&](auto &x) { return exact->closest(x, everywhere)->distance; },
    1e-9,
    0.2);
}



void
test_facets()
{
  // By all facets, with a sign from the angle under which they are seen.
  std::ofstream("l.csv")
    << "x, y\n0, 0\n1, 0\n1, 0.375\n0.25, 0.375\n0.25, 1\n0, 1\n";
  const auto facets = read_surface<2>("l.csv", "Body a/Shape file", 1.);
  const auto exact  = [&](const Point<2> &x) {
    double least = 1e9, angle = 0.;
    for (const auto &facet : facets)
      {
        const auto   a = facet[0] - x, b = facet[1] - x, ab = b - a;
        const double t = -(a * ab) / ab.norm_square();
        least =
          std::min(least, (a + std::max(0., std::min(1., t)) * ab).norm());
        angle += std::atan2(a[0] * b[1] - a[1] * b[0], a * b);
      }
    return angle > numbers::PI ? -least : least;
  };
  check_surface<2>("l.csv", *make_closest_surface<2>(facets), exact);
  check_surface<2>("L",
                   *from<2>("union(box(0, 0, 1, 0.375), box(0, 0, 0.25, 1))"),
                   exact);

  std::ofstream("cube.obj")
    << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 "
       "1\n"
       "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\n"
       "f 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";
  const Point<3> one(1., 1., 1.);
  const auto     mesh = make_closest_surface<3>(
    read_surface<3>("cube.obj", "Body a/Shape file", 1.));
  check_surface<3>("cube.obj", *mesh, to_box(Point<3>(), one));
  const auto corner = mesh->closest(Point<3>(1.2, 1.4, 1.4), everywhere);
  const auto box    = mesh->box().get_boundary_points();
  check("corner and box of the cube",
        corner->point.distance(one) + std::abs(corner->distance - 0.6) +
          box.first.norm() + box.second.distance(one),
        1e-14);
}



void
test_main()
{
  test_shapes();
  check_formula<2>("level_set(log(1 + (x - 0.4)^2 + (y - 0.6)^2) - log(1.25))",
                   "ball(0.4, 0.6, 0.5)");
  check_formula<3>("(x - 0.4)^2 + (y - 0.6)^2 + (z - 0.5)^2 < 0.25 & x > 0.2 & "
                   "z < 0.6",
                   "intersection(ball(0.4, 0.6, 0.5, 0.5), x > 0.2, z < 0.6)");
  test_facets();
  const auto box = from<3>("cylinder(0, 0, 0, 0.6, 0, 0.8, 0.5)")->box();
  check("box of a cylinder",
        box.point_inside(Point<3>(-0.4, -0.5, -0.3)) &&
          box.point_inside(Point<3>(1., 0.5, 1.1)) && box.volume() < 3.);
  check("half space", std::isinf(from<2>("y < 1")->box().volume()));
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// The closest points of surfaces of rigid bodies, and signed distances, at
// random points: against closed forms, against all facets of polygons and
// meshes, and against samples in the ball that has to be empty.

#include <greville/geometry/closest_surface.h>

#include <fstream>
#include <functional>
#include <random>
#include <tests.h>

// The same numbers on all machines.
double
random_number(const double from, const double to)
{
  static std::mt19937 generator(1);
  return from + (to - from) * (generator() / 4294967296.);
}

template <int dim>
Point<dim>
random_point(const double from, const double to)
{
  Point<dim> x;
  for (unsigned int d = 0; d < dim; ++d)
    x[d] = random_number(from, to);
  return x;
}

constexpr double everywhere = std::numeric_limits<double>::infinity();

template <int dim>
using Distance = std::function<double(const Point<dim> &)>;



// Errors of distances, which are also those between x and the closest point;
// normals as the gradient of the distance where that is smooth; searches that
// end nearby. Returns the closest points.
template <int dim>
std::vector<ClosestPoint<dim>>
check_surface(const std::string         &what,
              const ClosestSurface<dim> &surface,
              const Distance<dim>       &exact,
              const double               tolerance,
              const unsigned int         n     = 2000,
              const Tensor<1, dim>      &shift = Tensor<1, dim>())
{
  double distance_error = 0., point_error = 0., normal_error = 0.;
  double gradient_error = 0.;
  bool   has_all = true, has_sign = true, ends_nearby = true, is_near = true;
  unsigned int                   n_smooth = 0;
  std::vector<ClosestPoint<dim>> result;
  for (unsigned int k = 0; k < n; ++k)
    {
      const Point<dim> x     = random_point<dim>(-1., 2.) + shift;
      const auto       found = surface.closest(x, everywhere);
      has_all                = has_all && found;
      if (!found)
        continue;
      result.push_back(*found);
      const double wanted   = exact(x);
      const double distance = found->distance;
      distance_error = std::max(distance_error, std::abs(distance - wanted));
      has_sign =
        has_sign && (distance * wanted > 0. || std::abs(wanted) < tolerance);
      point_error =
        std::max(point_error,
                 std::abs(exact(found->point)) +
                   std::abs(x.distance(found->point) - std::abs(distance)));
      normal_error =
        std::max(normal_error,
                 (x - found->point - distance * found->normal).norm() +
                   std::abs(found->normal.norm() - 1.));
      ends_nearby =
        ends_nearby && !surface.closest(x, (1. - 1e-6) * std::abs(distance));
      const auto near = surface.closest(x, (1. + 1e-6) * std::abs(distance));
      is_near = is_near && near && std::abs(near->distance - distance) < 1e-9;
      if (k % 4 == 0 && std::abs(distance) > 1e-3)
        {
          const double   step = 1e-6;
          Tensor<1, dim> gradient;
          bool           is_smooth = true;
          for (unsigned int d = 0; d < dim; ++d)
            for (const int side : {-1, 1})
              {
                Point<dim> shifted = x;
                shifted[d] += side * step;
                const auto next = surface.closest(shifted, everywhere);
                gradient[d] += side * next->distance / (2. * step);
                is_smooth = is_smooth &&
                            next->point.distance(found->point) < 1000. * step;
              }
          if (is_smooth)
            {
              gradient_error =
                std::max(gradient_error, (gradient - found->normal).norm());
              ++n_smooth;
            }
        }
    }
  check(what + ": something is closest", has_all);
  check(what + ": distance", distance_error, tolerance);
  check(what + ": sign", has_sign);
  check(what + ": point", point_error, 2. * tolerance);
  check(what + ": normal", normal_error, 2. * tolerance);
  check(what + ": gradient", gradient_error, 2e-5);
  check(what + ": most gradients", n_smooth > n / 6);
  check(what + ": no search too far", ends_nearby);
  check(what + ": search nearby", is_near);
  return result;
}



// The distance in the plane from a box.
double
to_box(const Point<2> &x, const Point<2> &lower, const Point<2> &upper)
{
  const Tensor<1, 2> q({std::max(lower[0] - x[0], x[0] - upper[0]),
                        std::max(lower[1] - x[1], x[1] - upper[1])});
  if (q[0] < 0. && q[1] < 0.)
    return std::max(q[0], q[1]);
  return std::hypot(std::max(q[0], 0.), std::max(q[1], 0.));
}

double
to_box(const Point<3> &x, const Point<3> &lower, const Point<3> &upper)
{
  Tensor<1, 3> q;
  double       largest = -1e9, square = 0.;
  for (unsigned int d = 0; d < 3; ++d)
    {
      q[d]    = std::max(lower[d] - x[d], x[d] - upper[d]);
      largest = std::max(largest, q[d]);
      square += std::pow(std::max(q[d], 0.), 2);
    }
  return largest < 0. ? largest : std::sqrt(square);
}



// From the part of a circle around c that lies where is_part says, with the
// ends e.
double
to_arc(const Point<2>                              &x,
       const Point<2>                              &c,
       const double                                 r,
       const std::function<bool(const Point<2> &)> &is_part,
       const Point<2>                              &e)
{
  const Point<2> y = c + r / x.distance(c) * (x - c);
  return is_part(y)
           ? x.distance(y)
           : std::min(x.distance(e), x.distance(Point<2>(e[0], -e[1])));
}

// A ball around the origin without (or with) another one on the first axis.
double
to_balls(const Point<2> &x,
         const double    a,
         const double    center,
         const double    b,
         const bool      is_union)
{
  const Point<2> origin, c(center, 0.);
  const double   along = 0.5 * (a * a - b * b + center * center) / center;
  const Point<2> end(along, std::sqrt(a * a - along * along));
  const auto     in_a  = [&](const Point<2> &y) { return y.norm() < a; };
  const auto     in_b  = [&](const Point<2> &y) { return y.distance(c) < b; };
  const auto     not_a = [&](const Point<2> &y) { return !in_a(y); };
  const auto     not_b = [&](const Point<2> &y) { return !in_b(y); };
  const double   to_a  = to_arc(x, origin, a, not_b, end);
  const double   to_b =
    is_union ? to_arc(x, c, b, not_a, end) : to_arc(x, c, b, in_a, end);
  const bool inside = is_union ? in_a(x) || in_b(x) : in_a(x) && !in_b(x);
  return (inside ? -1. : 1.) * std::min(to_a, to_b);
}



void
test_closed_forms()
{
  print() << "Closed forms" << std::endl;
  const double planar = 1e-12;
  const auto   from   = [](const std::string &formula) {
    return make_closest_surface<2>(formula, "Body a/Shape");
  };
  const auto from_3d = [](const std::string &formula) {
    return make_closest_surface<3>(formula, "Body a/Shape");
  };
  check_surface<2>(
    "disk",
    *from("ball(0.4, 0.6, 0.5)"),
    [](const Point<2> &x) { return x.distance(Point<2>(0.4, 0.6)) - 0.5; },
    planar);
  check_surface<3>(
    "ball",
    *from_3d("ball(0.4, 0.6, 0.3, 0.5)"),
    [](const Point<3> &x) { return x.distance(Point<3>(0.4, 0.6, 0.3)) - 0.5; },
    planar);
  check_surface<2>(
    "half space in 2D",
    *from("half_space(3, 4, 2)"),
    [](const Point<2> &x) { return 0.6 * x[0] + 0.8 * x[1] - 0.4; },
    planar);
  check_surface<3>(
    "half space in 3D",
    *from_3d("2 * x - y + 2 * z < 0.6"),
    [](const Point<3> &x) { return (2. * x[0] - x[1] + 2. * x[2]) / 3. - 0.2; },
    planar);

  const Point<2> low(0., 0.2), high(1., 0.9);
  const auto     box = from("box(0, 0.2, 1, 0.9)");
  check_surface<2>(
    "box in 2D",
    *box,
    [&](const Point<2> &x) { return to_box(x, low, high); },
    planar);
  const auto corner = box->closest(Point<2>(1.3, 1.3), everywhere);
  check("corner of a box: point", corner->point.distance(high), 1e-15);
  check("corner of a box: normal",
        (corner->normal - Tensor<1, 2>({0.6, 0.8})).norm(),
        1e-14);
  check("corner of a box: distance", std::abs(corner->distance - 0.5), 1e-15);
  const auto at_corner = box->closest(high, everywhere);
  check(
    "at the corner itself",
    std::abs(at_corner->distance) +
      (at_corner->normal - Tensor<1, 2>({std::sqrt(.5), std::sqrt(.5)})).norm(),
    1e-14);
  const auto at_side = box->closest(Point<2>(1., 0.5), 1e-3);
  check("at a side",
        std::abs(at_side->distance) +
          (at_side->normal - Tensor<1, 2>({1., 0.})).norm(),
        1e-14);
  check_surface<3>(
    "box in 3D",
    *from_3d("box(0, 0.2, 0.1, 1, 0.9, 0.6)"),
    [](const Point<3> &x) {
      return to_box(x, Point<3>(0., 0.2, 0.1), Point<3>(1., 0.9, 0.6));
    },
    planar);
  // Faces between parts of a union are no surface.
  check_surface<2>(
    "two boxes side by side",
    *from("union(box(0, 0.2, 0.4, 0.9), box(0.4, 0.2, 1, 0.9))"),
    [&](const Point<2> &x) { return to_box(x, low, high); },
    planar);
  check_surface<2>(
    "triangles around a point",
    *from("union(intersection(y > 0.2, y - 0.5 < x - 0.3, x - 0.3 < 0.5 - y), "
          "intersection(x > 0, y > 0.2, y < 0.9, y - 0.5 > x - 0.3, "
          "x - 0.3 < 0.5 - y), "
          "intersection(x > 0, y < 0.9, y - 0.5 > x - 0.3, x - 0.3 > 0.5 - y), "
          "intersection(y > 0.2, y < 0.9, x < 1, y - 0.5 < x - 0.3, "
          "x - 0.3 > 0.5 - y))"),
    [&](const Point<2> &x) { return to_box(x, low, high); },
    planar);
  // Coordinates far from zero.
  const Tensor<1, 2> shift({1000., -2000.});
  check_surface<2>(
    "box far away",
    *from("box(1000, -1999.8, 1001, -1999.1)"),
    [&](const Point<2> &x) { return to_box(x, low + shift, high + shift); },
    1e-11,
    500,
    shift);

  for (const bool is_union : {false, true})
    {
      const std::string name = is_union ? "union" : "difference";
      check_surface<2>(
        name + " of disks",
        *from(name + "(ball(0, 0, 0.8), ball(0.9, 0, 0.6))"),
        [&](const Point<2> &x) { return to_balls(x, 0.8, 0.9, 0.6, is_union); },
        planar);
      check_surface<3>(
        name + " of balls",
        *from_3d(name + "(ball(0.3, 0, 0, 0.8), ball(0.3, 0.9, 0, 0.6))"),
        [&](const Point<3> &x) {
          return to_balls(Point<2>(x[1], std::hypot(x[0] - 0.3, x[2])),
                          0.8,
                          0.9,
                          0.6,
                          is_union);
        },
        planar);
    }

  const Point<3>     begin(0.1, 0.3, 0.2), end(0.7, 1.1, 0.5);
  const double       length   = begin.distance(end);
  const Tensor<1, 3> axis     = (end - begin) / length;
  const auto         cylinder = [&](const Point<3> &x) {
    const double along = axis * (x - begin);
    const double out   = (x - begin - along * axis).norm();
    return to_box(Point<2>(along, out),
                  Point<2>(0., -0.4),
                  Point<2>(length, 0.4));
  };
  const auto tilted = from_3d("cylinder(0.1, 0.3, 0.2, 0.7, 1.1, 0.5, 0.4)");
  check_surface<3>("cylinder", *tilted, cylinder, planar);
  const auto rim =
    tilted->closest(end + 0.3 * axis +
                      0.8 *
                        cross_product_3d(axis, Tensor<1, 3>({0.8, -0.6, 0.})),
                    everywhere);
  check("rim of a cylinder",
        std::abs(rim->distance - 0.5) + std::abs(axis * (rim->point - end)),
        1e-14);
}



// Where closed forms are long: no sample of the other side is nearer than the
// closest point, which has both sides around it.
template <int dim>
void
check_samples(const std::string &formula, const unsigned int n = 200)
{
  const auto       surface = make_closest_surface<dim>(formula, "Body a/Shape");
  const Shape<dim> shape(formula, "Body a/Shape");
  unsigned int     n_nearer = 0, n_beside = 0, n_missing = 0, n_sign = 0;
  for (unsigned int k = 0; k < n; ++k)
    {
      const Point<dim> x     = random_point<dim>(-1., 2.);
      const auto       found = surface->closest(x, everywhere);
      if (!found)
        {
          ++n_missing;
          continue;
        }
      const bool   inside   = shape.contains(x);
      const double distance = std::abs(found->distance);
      n_sign += inside != (found->distance < 0.);
      bool one = false, other = false;
      for (unsigned int s = 0; s < 300; ++s)
        {
          // Around x, and around the closest point.
          const Point<dim> part = random_point<dim>(-1., 1.);
          const Point<dim> y =
            s % 2 == 0
              ? x + distance * part
              : found->point + Tensor<1, dim>(std::pow(0.5, s % 12) * part);
          if (y.distance(x) < (1. - 1e-9) * distance)
            n_nearer += shape.contains(y) != inside;
          const Point<dim> beside = found->point + Tensor<1, dim>(1e-9 * part);
          (shape.contains(beside) ? one : other) = true;
        }
      n_beside += !(one && other);
    }
  check(formula + ": something is closest", n_missing == 0);
  check(formula + ": sign", n_sign == 0);
  check(formula + ": nothing is nearer", n_nearer, 0.);
  check(formula + ": on the surface", n_beside, 0.);
}



void
test_samples()
{
  print() << "Samples" << std::endl;
  check_samples<2>("difference(box(0, 0, 1, 1), ball(1, 1, 0.5), "
                   "half_space(1, 2, 0.5))");
  check_samples<2>("union(box(0, 0, 1, 0.3), box(0.2, 0.1, 0.5, 1), "
                   "ball(0.9, 0.5, 0.4))");
  check_samples<2>("x > 0 & x^2 + 3 * y^2 < 1 & y < 0.5 | "
                   "(x - 1)^2 + (y - 1)^2 < 0.2");
  check_samples<2>("level_set(y - 0.5 - 0.2 * sin(5 * x))");
  check_samples<2>("intersection(level_set(y - 0.5 - 0.2 * sin(5 * x)), "
                   "box(-0.7, -0.3, 1.2, 1.5))");
  check_samples<3>("difference(box(0, 0, 0, 1, 1, 1), ball(1, 1, 1, 0.5), "
                   "half_space(1, 2, 1, 0.5))");
  check_samples<3>("union(box(0, 0, 0, 1, 0.3, 1), box(0.2, 0.1, 0.3, 0.5, 1, "
                   "0.8), ball(0.9, 0.5, 0.6, 0.4))");
  check_samples<3>("difference(box(0, 0, 0, 1, 1, 1), "
                   "cylinder(0.2, -1, 0.5, 0.8, 2, 0.4, 0.2))");
  check_samples<3>("union(cylinder(-0.5, 0.5, 0.5, 1.5, 0.5, 0.5, 0.4), "
                   "cylinder(0.5, 0.5, 0.5, 0.6, 0.7, 1.6, 0.25))");
  check_samples<3>("difference(cylinder(-0.5, 0.5, 0.5, 1.5, 0.4, 0.5, 0.5), "
                   "ball(0.6, 0.9, 0.6, 0.35))");
  check_samples<3>("intersection(cylinder(0, 0, -0.5, 0, 0, 1.5, 0.6), "
                   "cylinder(0.5, 0, -0.5, 0.5, 0, 1.5, 0.7), "
                   "half_space(1, 0, 1, 1.1))");
  check_samples<3>("intersection(ball(0, 0, 0, 0.8), ball(0.5, 0, 0, 0.8), "
                   "ball(0.2, 0.6, 0.1, 0.8))");
  check_samples<3>("x^2 + 2 * y^2 + 3 * z^2 < 1", 100);
  check_samples<3>("difference(x^2 + 2 * y^2 + 3 * z^2 < 1, box(0, 0, 0, 2, 2, "
                   "2))",
                   100);
}



// Formulas are the same as the shapes in their place.
template <int dim>
void
check_formula(const std::string &formula, const std::string &exact)
{
  const auto surface = make_closest_surface<dim>(formula, "Body a/Shape");
  const auto other   = make_closest_surface<dim>(exact, "Body a/Shape");
  check_surface<dim>(
    formula,
    *surface,
    [&](const Point<dim> &x) {
      return other->closest(x, everywhere)->distance;
    },
    1e-9,
    dim == 2 ? 500 : 200);
}



void
test_formulas()
{
  print() << "Formulas" << std::endl;
  check_formula<2>("level_set((x - 0.4)^2 + (y - 0.6)^2 - 0.25)",
                   "ball(0.4, 0.6, 0.5)");
  check_formula<2>("level_set(log(1 + (x - 0.4)^2 + (y - 0.6)^2) - log(1.25))",
                   "ball(0.4, 0.6, 0.5)");
  check_formula<2>("(x - 0.4)^2 + (y - 0.6)^2 < 0.25 & y < 0.7 & x > 0.1",
                   "intersection(ball(0.4, 0.6, 0.5), y < 0.7, x > 0.1)");
  check_formula<2>("difference(box(0, 0, 1, 1), x^2 + y^2 < 0.5, "
                   "(x - 1)^2 + y^2 < 0.4)",
                   "difference(box(0, 0, 1, 1), ball(0, 0, sqrt(0.5)), "
                   "ball(1, 0, sqrt(0.4)))");
  check_formula<3>("(x - 0.4)^2 + (y - 0.6)^2 + (z - 0.5)^2 < 0.25 & y < 0.7 & "
                   "x > 0.2 & z < 0.6",
                   "intersection(ball(0.4, 0.6, 0.5, 0.5), y < 0.7, x > 0.2, "
                   "z < 0.6)");
  // Grains of a millimetre.
  const auto grain =
    make_closest_surface<2>("(x - 0.002)^2 + y^2 < 1e-6", "Body a/Shape");
  double error = 0.;
  for (unsigned int k = 0; k < 100; ++k)
    {
      const Point<2> x     = random_point<2>(-0.003, 0.003);
      const auto     found = grain->closest(x, 0.01);
      error                = std::max(error,
                       std::abs(found->distance -
                                (x.distance(Point<2>(0.002, 0.)) - 0.001)));
    }
  check("grain", error, 1e-12);
}



// By all facets: the least distance, and the share of the view from x.
double
by_facets(const ClosedSurface<2> &surface, const Point<2> &x)
{
  double least = 1e9, angle = 0.;
  for (const auto &facet : surface)
    {
      const auto   a = facet[0] - x, b = facet[1] - x, ab = b - a;
      const double t = std::max(0., std::min(1., -(a * ab) / ab.norm_square()));
      least          = std::min(least, (a + t * ab).norm());
      angle += std::atan2(a[0] * b[1] - a[1] * b[0], a * b);
    }
  return angle > numbers::PI ? -least : least;
}

double
by_facets(const ClosedSurface<3> &surface, const Point<3> &x)
{
  double least = 1e9, angle = 0.;
  for (const auto &facet : surface)
    {
      const std::array<Tensor<1, 3>, 3> r = {
        {facet[0] - x, facet[1] - x, facet[2] - x}};
      const double a = r[0].norm(), b = r[1].norm(), c = r[2].norm();
      angle += 2. * std::atan2(r[0] * cross_product_3d(r[1], r[2]),
                               a * b * c + (r[0] * r[1]) * c +
                                 (r[1] * r[2]) * a + (r[2] * r[0]) * b);
      for (unsigned int k = 0; k < 3; ++k)
        {
          const auto   ab = r[(k + 1) % 3] - r[k];
          const double t =
            std::max(0., std::min(1., -(r[k] * ab) / ab.norm_square()));
          least = std::min(least, (r[k] + t * ab).norm());
        }
      // Barycentric coordinates of the foot of x.
      const auto   u = r[1] - r[0], v = r[2] - r[0];
      const double uu = u * u, uv = u * v, vv = v * v;
      const double p = -(r[0] * u), q = -(r[0] * v);
      const double determinant = uu * vv - uv * uv;
      const double s           = (vv * p - uv * q) / determinant;
      const double t           = (uu * q - uv * p) / determinant;
      if (s >= 0. && t >= 0. && s + t <= 1.)
        {
          const auto normal = cross_product_3d(u, v);
          least = std::min(least, std::abs(r[0] * normal) / normal.norm());
        }
    }
  return angle > 2. * numbers::PI ? -least : least;
}



template <int dim>
void
check_facets(const std::string &file, const unsigned int n)
{
  const auto facets  = read_surface<dim>(file, "Body a/Shape file", 1.);
  const auto surface = make_closest_surface<dim>(facets);
  const auto exact = [&](const Point<dim> &x) { return by_facets(facets, x); };
  check_surface<dim>(file, *surface, exact, 1e-12, n);

  // Close to edges and corners.
  bool   has_sign = true;
  double error    = 0.;
  for (unsigned int k = 0; k < n; ++k)
    {
      const Facet<dim> &facet = facets[k % facets.size()];
      const double      t     = k % 3 == 0 ? 0. : random_number(0., 1.);
      const double      size  = std::pow(10., -1. - k % 6);
      const Point<dim>  x     = facet[0] + t * (facet[1] - facet[0]) +
                           Tensor<1, dim>(random_point<dim>(-size, size));
      const double wanted = by_facets(facets, x);
      const double found  = surface->closest(x, 2. * dim * size)->distance;
      has_sign = has_sign && (wanted * found > 0. || std::abs(wanted) < 1e-12);
      error    = std::max(error, std::abs(wanted - found));
    }
  check(file + ": sign close to edges", has_sign);
  check(file + ": distance close to edges", error, 1e-12);
  // At corners themselves, with a normal that points outwards.
  bool is_outwards = true;
  for (const Facet<dim> &facet : facets)
    {
      const auto at = surface->closest(facet[0], 1e-3);
      is_outwards   = is_outwards && at && at->distance < 1e-15 &&
                    std::abs(at->normal.norm() - 1.) < 1e-14;
    }
  check(file + ": at corners", is_outwards);
}



void
write_file(const std::string &file, const std::string &text)
{
  std::ofstream(file) << text;
}

std::string
as_stl(const std::vector<std::array<Point<3>, 3>> &triangles)
{
  std::ostringstream text;
  text << std::setprecision(9) << "solid body\n";
  for (const auto &triangle : triangles)
    {
      text << "facet normal 0 0 0\nouter loop\n";
      for (const auto &x : triangle)
        text << "vertex " << x << "\n";
      text << "endloop\nendfacet\n";
    }
  text << "endsolid body\n";
  return text.str();
}



void
test_facets()
{
  print() << "Facets" << std::endl;
  write_file("l.csv",
             "x, y\n0, 0\n1, 0\n1, 0.375\n0.25, 0.375\n0.25, 1\n0, 1\n");
  check_facets<2>("l.csv", 2000);
  // The same as a formula: a concave edge.
  const std::string l       = "union(box(0, 0, 1, 0.375), box(0, 0, 0.25, 1))";
  const auto        polygon = read_surface<2>("l.csv", "Body a/Shape file", 1.);
  check_surface<2>(
    "L of boxes",
    *make_closest_surface<2>(l, "Body a/Shape"),
    [&](const Point<2> &x) { return by_facets(polygon, x); },
    1e-12);
  // A hole, and sharp corners.
  write_file("sharp.csv",
             "x, y, loop\n-0.5, 0, 0\n1.5, 0.1, 0\n0.3, 0.2, 0\n0.2, 1.5, 0\n"
             "0.1, 0.05, 1\n0.15, 0.05, 1\n0.12, 0.2, 1\n");
  check_facets<2>("sharp.csv", 2000);

  std::vector<std::array<Point<3>, 3>> cube, ball;
  for (unsigned int d = 0; d < 3; ++d)
    for (const int side : {0, 1})
      {
        std::array<Point<3>, 4> c;
        for (unsigned int k = 0; k < 4; ++k)
          {
            c[k][d]           = side;
            c[k][(d + 1) % 3] = k == 1 || k == 2;
            c[k][(d + 2) % 3] = k >= 2;
          }
        if (side == 0)
          std::swap(c[1], c[3]);
        cube.push_back({{c[0], c[1], c[2]}});
        cube.push_back({{c[0], c[2], c[3]}});
        // The faces of a cube, blown up.
        const unsigned int n = 6;
        const auto at        = [&](const unsigned int i, const unsigned int j) {
          const double   u = double(i) / n, v = double(j) / n;
          const Point<3> x((1. - u) * ((1. - v) * c[0] + v * c[3]) +
                           u * ((1. - v) * c[1] + v * c[2]));
          Tensor<1, 3>   out = x - Point<3>(0.5, 0.5, 0.5);
          out *= 0.8 / out.norm();
          // As floats, and the same from all faces.
          Point<3> y;
          for (unsigned int e = 0; e < 3; ++e)
            y[e] = std::round((0.5 + out[e]) * 1048576.) / 1048576.;
          return y;
        };
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            {
              ball.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1)}});
              ball.push_back({{at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
            }
      }
  write_file("cube.stl", as_stl(cube));
  write_file("ball.stl", as_stl(ball));
  check_facets<3>("cube.stl", 1000);
  check_facets<3>("ball.stl", 500);
  const auto from_cube = make_closest_surface<3>(
    read_surface<3>("cube.stl", "Body a/Shape file", 1.));
  const auto corner = from_cube->closest(Point<3>(1.2, 1.4, 1.4), everywhere);
  check("corner of the cube",
        corner->point.distance(Point<3>(1., 1., 1.)) +
          std::abs(corner->distance - 0.6) +
          (corner->normal - Tensor<1, 3>({1. / 3., 2. / 3., 2. / 3.})).norm(),
        1e-14);
  check("cube: box",
        from_cube->box().get_boundary_points().first.norm() +
          from_cube->box().get_boundary_points().second.distance(
            Point<3>(1., 1., 1.)),
        1e-15);
}



// Boxes around shapes, and pictures.
template <int dim>
void
check_box(const std::string &formula,
          const Point<dim>  &lower,
          const Point<dim>  &upper,
          const double       tolerance = 1e-14)
{
  const auto box = make_closest_surface<dim>(formula, "Body a/Shape")->box();
  for (unsigned int d = 0; d < dim; ++d)
    for (const int side : {-1, 1})
      {
        const double found = side < 0 ? box.lower_bound(d) : box.upper_bound(d);
        const double wanted = side < 0 ? lower[d] : upper[d];
        check("box of " + formula,
              found == wanted || (std::abs(found - wanted) <= tolerance &&
                                  side * (found - wanted) > -1e-14));
      }
}



template <int dim>
void
check_pictures(const std::string &formula, const double volume)
{
  const auto surface = make_closest_surface<dim>(formula, "Body a/Shape");
  Point<dim> lower, upper;
  for (unsigned int d = 0; d < dim; ++d)
    {
      lower[d] = -2.;
      upper[d] = 2.;
    }
  double         sum = 0., off = 0.;
  Tensor<1, dim> area;
  const auto facets = surface->facets(0.05, BoundingBox<dim>({lower, upper}));
  for (const auto &facet : facets)
    {
      Tensor<1, dim> normal;
      if constexpr (dim == 2)
        normal = -cross_product_2d(facet[0] - facet[1]);
      else
        normal =
          0.5 * cross_product_3d(facet[1] - facet[0], facet[2] - facet[0]);
      sum += normal * facet[0] / dim;
      area += normal;
      for (const auto &x : facet)
        off = std::max(off, std::abs(surface->closest(x, 1.)->distance));
    }
  check(formula + ": facets are closed", area.norm(), 1e-12);
  check(formula + ": facets are on the surface", off, 1e-12);
  check(formula + ": volume in facets", std::abs(sum / volume - 1.), 0.01);
}



void
test_boxes_and_pictures()
{
  print() << "Boxes and pictures" << std::endl;
  check_box<2>("ball(0.4, 0.6, 0.5)", {-0.1, 0.1}, {0.9, 1.1});
  check_box<2>("half_space(0, 1, 0.5)",
               {-everywhere, -everywhere},
               {everywhere, 0.5});
  check_box<2>("half_space(1, 2, 0.5)",
               {-everywhere, -everywhere},
               {everywhere, everywhere});
  check_box<2>("intersection(half_space(1, 1, 1), half_space(-1, 1, 1), "
               "half_space(1, -1, 1), half_space(-1, -1, 1))",
               {-1., -1.},
               {1., 1.},
               1e-2);
  check_box<3>("union(box(0, 0, 0, 1, 1, 1), ball(1, 1, 1, 0.5))",
               {0., 0., 0.},
               {1.5, 1.5, 1.5});
  check_box<3>("cylinder(0, 0, -0.5, 0, 0, 1.5, 0.6)",
               {-0.6, -0.6, -0.5},
               {0.6, 0.6, 1.5});
  const double r = 0.2 / std::sqrt(2.);
  check_box<3>("cylinder(0, 0, 0, 1, 1, 0, 0.2)",
               {-r, -r, -0.2},
               {1. + r, 1. + r, 0.2},
               5e-2);
  check_pictures<2>("ball(0.4, 0.6, 0.5)", 0.25 * numbers::PI);
  check_pictures<2>("difference(box(0, 0, 1, 1), ball(1, 1, 0.5))",
                    1. - numbers::PI / 16.);
  check_pictures<3>("ball(0.1, 0.2, 0.3, 0.8)", 4. / 3. * numbers::PI * 0.512);
}



void
test_errors()
{
  print() << "Errors" << std::endl;
  for (const std::string shape :
       {"sin(x)", "ball(0.5, 0.5, -1)", "ball(0.5, 0.5)"})
    {
      std::string message = "nothing is wrong";
      try
        {
          make_closest_surface<2>(shape, "Body a/Shape");
        }
      catch (const std::exception &error)
        {
          message = message_of(error);
        }
      print() << "  " << message << std::endl;
    }
}



void
test_main()
{
  test_closed_forms();
  test_samples();
  test_formulas();
  test_facets();
  test_boxes_and_pictures();
  test_errors();
}

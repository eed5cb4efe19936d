// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks quadratures on a box cut by planes, and on the cuts, also after
// compression. The reference is the integral of monomials over the simplex of
// all x >= 0 with x_1 + ... + x_dim <= a,
//   prod k_d! a^(dim + |k|) / (dim + |k|)!,
// and over its oblique face,
//   sqrt(dim) prod k_d! a^(dim - 1 + |k|) / (dim - 1 + |k|)!.

#include <greville/geometry/compressed_quadrature.h>

#include <cmath>
#include <functional>
#include <tests.h>

template <int dim>
void
for_each_exponent(const unsigned int                                  degree,
                  const std::function<void(const MultiIndex<dim> &)> &visit)
{
  const MultiIndex<dim> sizes = cube<dim>(degree + 1);
  for (unsigned int i = 0; i < std::pow(degree + 1, dim); ++i)
    {
      const MultiIndex<dim> k     = multi_index<dim>(i, sizes);
      unsigned int          total = 0;
      for (unsigned int d = 0; d < dim; ++d)
        total += k[d];
      if (total <= degree)
        visit(k);
    }
}



// The largest relative error of all monomials up to this degree.
template <int dim, typename Points>
double
largest_error(const Points      &points,
              const unsigned int degree,
              const double       a,
              const int          dimension,
              const double       factor)
{
  double largest = 0.;
  for_each_exponent<dim>(degree, [&](const MultiIndex<dim> &k) {
    double       exact = factor;
    unsigned int total = 0;
    for (unsigned int d = 0; d < dim; ++d)
      {
        exact *= std::tgamma(k[d] + 1.);
        total += k[d];
      }
    exact *=
      std::pow(a, dimension + total) / std::tgamma(dimension + total + 1.);
    double sum = 0.;
    for (const auto &point : points)
      {
        double product = point.weight;
        for (unsigned int d = 0; d < dim; ++d)
          product *= std::pow(point.x[d], k[d]);
        sum += product;
      }
    largest = std::max(largest, std::abs(sum / exact - 1.));
  });
  return largest;
}



template <int dim>
BoundingBox<dim>
unit_box()
{
  Point<dim> upper;
  for (unsigned int d = 0; d < dim; ++d)
    upper[d] = 1.;
  return BoundingBox<dim>({Point<dim>(), upper});
}



template <int dim>
Plane<dim>
oblique_plane(const double a)
{
  Plane<dim> plane;
  for (unsigned int d = 0; d < dim; ++d)
    plane.normal[d] = 1. / std::sqrt(1. * dim);
  plane.offset = a / std::sqrt(1. * dim);
  return plane;
}



template <int dim>
void
test()
{
  const double          a = 0.8, tolerance = 1e-12;
  const std::string     name = std::to_string(dim) + "D, ";
  const ConvexPart<dim> box(unit_box<dim>());
  const Plane<dim>      plane = oblique_plane<dim>(a);
  ConvexPart<dim>       simplex, rest, nothing, all;
  Facet<dim>            face, other;
  check(name + "both parts have an extent",
        box.split(plane, tolerance, simplex, rest, face));
  check(name + "a plane through a corner cuts nothing",
        !box.split(oblique_plane<dim>(0.), tolerance, nothing, all, other));
  check(
    name + "a plane beside the box cuts nothing",
    !box.split(oblique_plane<dim>(dim + 1.), tolerance, all, nothing, other));
  check(name + "the center is inside",
        plane.distance(simplex.center()) < 0. &&
          plane.distance(rest.center()) > 0.);
  check(name + "the cut is in the plane",
        std::abs(plane.distance(center_of<dim>(face))),
        1e-14);

  for (unsigned int n = 1; n <= 4; ++n)
    {
      const unsigned int degree = 2 * n - 1;
      const std::string  order  = name + "n = " + std::to_string(n) + ", ";
      std::vector<WeightedPoint<dim>> points;
      simplex.append_quadrature(n, points);
      check(order + "simplex",
            largest_error<dim>(points, degree, a, dim, 1.),
            1e-12);
      bool are_positive = true, are_inside = true;
      for (const auto &point : points)
        {
          are_positive = are_positive && point.weight > 0.;
          are_inside   = are_inside && plane.distance(point.x) <= 0.;
        }
      check(order + "weights are positive", are_positive);
      check(order + "points are inside", are_inside);

      std::vector<WeightedSurfacePoint<dim>> on_face;
      append_quadrature<dim>(face, plane.normal, n, on_face);
      check(
        order + "face",
        largest_error<dim>(on_face, degree, a, dim - 1, std::sqrt(1. * dim)),
        1e-12);

      // The rest completes the box.
      rest.append_quadrature(n, points);
      double volume = 0.;
      for (const auto &point : points)
        volume += point.weight;
      check(order + "volume", std::abs(volume - 1.), 1e-13);

      // Fewer points, the same integrals.
      points.clear();
      ConvexPart<dim> upper, lower;
      Plane<dim>      middle;
      middle.normal[0] = 1.;
      middle.offset    = 0.3 * a;
      check(order + "a part is cut again",
            simplex.split(middle, tolerance, lower, upper, other));
      lower.append_quadrature(n, points);
      upper.append_quadrature(n, points);
      const std::size_t n_before = points.size();
      compress_quadrature<dim>(points, degree);
      check(order + "compressed",
            largest_error<dim>(points, degree, a, dim, 1.),
            1e-11);
      check(order + "few points are left",
            points.size() <= n_polynomials<dim>(degree) &&
              points.size() <= n_before);
      are_positive = true;
      for (const auto &point : points)
        are_positive = are_positive && point.weight > 0.;
      check(order + "compressed weights are positive", are_positive);
      print() << "  " << order << "polynomials: " << n_polynomials<dim>(degree)
              << std::endl;
    }

  // A facet and the plane x_1 = 1/4.
  Plane<dim> cut;
  cut.normal[0] = 1.;
  cut.offset    = 0.25;
  Facet<dim> below, above;
  split_facet<dim>(face, cut, tolerance, below, above);
  std::vector<WeightedSurfacePoint<dim>> parts;
  append_quadrature<dim>(below, plane.normal, 2, parts);
  for (const auto &point : parts)
    check(name + "below", point.x[0] <= 0.25);
  append_quadrature<dim>(above, plane.normal, 2, parts);
  check(name + "parts of the face",
        largest_error<dim>(parts, 3, a, dim - 1, std::sqrt(1. * dim)),
        1e-12);
  cut = plane;
  split_facet<dim>(face, cut, tolerance, below, above);
  check(name + "a facet in the plane is below it",
        !below.empty() && above.empty());
}



void
test_main()
{
  test<2>();
  test<3>();
}

// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks points that follow the boundary of a shape, and points on it: volumes,
// centres, moments of inertia and areas, which are exact or converge with order
// 2 n, and refused input.

#include <greville/geometry/fitted_points.h>

#include <fstream>
#include <functional>
#include <set>
#include <tests.h>

const double pi = numbers::PI;

PointPlacement
fitted(const std::string &shape, const unsigned int n)
{
  PointPlacement placement;
  placement.shape                = shape;
  placement.points_per_direction = {n};
  placement.placement            = Placement::fitted;
  return placement;
}



// Over a body: of 1, x, |x|^2. Over its surface: of 1, the normal, x . n / dim.
template <int dim>
struct Integrals
{
  double         volume = 0., inertia = 0., area = 0., flux = 0.;
  double         n_points = 0.;
  Tensor<1, dim> center, normal;
};



template <int dim>
Integrals<dim>
integrate(const PointPlacement &placement, const MultiIndex<dim> &cells)
{
  Box<dim>                box(cells);
  const SplineSpace<dim>  space(box.mesh, 2);
  Integrals<dim>          sums;
  bool                    are_inside = true, are_positive = true;
  std::set<std::uint64_t> ids;
  const auto is_in_cell = [&](const Point<dim> &x, const unsigned int cell) {
    return space.find(x) == cell;
  };
  std::vector<PlacedPoint<dim>>  points;
  std::vector<SurfacePoint<dim>> surface;
  run_on_all(MPI_COMM_WORLD, [&]() {
    points  = place_points(placement, "Body a", space);
    surface = place_surface_points(placement, "Body a", space);
  });
  for (const auto &point : points)
    {
      sums.volume += point.volume;
      sums.inertia += point.volume * point.x.norm_square();
      sums.center += point.volume * point.x;
      sums.n_points += 1.;
      are_positive = are_positive && point.volume > 0.;
      are_inside   = are_inside && is_in_cell(point.x, point.cell);
      ids.insert(point.id);
    }
  const std::string what = "  " + placement.shape + ": ";
  check(what + "volumes are positive", are_positive);
  check(what + "points are in their cells", are_inside);
  check(what + "ids are unique", ids.size() == points.size());
  ids.clear();
  for (const auto &point : surface)
    {
      sums.area += point.area;
      sums.normal += point.area * point.normal;
      sums.flux += point.area * (point.x * point.normal) / dim;
      are_inside = are_inside && is_in_cell(point.x, point.cell);
      ids.insert(point.id);
    }
  check(what + "surface points are in their cells", are_inside);
  check(what + "ids of the surface are unique", ids.size() == surface.size());
  for (double *sum :
       {&sums.volume, &sums.inertia, &sums.area, &sums.flux, &sums.n_points})
    *sum = Utilities::MPI::sum(*sum, MPI_COMM_WORLD);
  sums.center = Utilities::MPI::sum(sums.center, MPI_COMM_WORLD) / sums.volume;
  sums.normal = Utilities::MPI::sum(sums.normal, MPI_COMM_WORLD);
  return sums;
}



// The largest error of the body, and of its surface.
template <int dim>
std::pair<double, double>
errors(const Integrals<dim> &sums,
       const double          volume,
       const Tensor<1, dim> &center,
       const double          inertia,
       const double          area)
{
  return {std::max({std::abs(sums.volume / volume - 1.),
                    (sums.center - center).norm(),
                    std::abs(sums.inertia / inertia - 1.)}),
          std::max({std::abs(sums.area / area - 1.),
                    sums.normal.norm() / area,
                    std::abs(sums.flux / volume - 1.)})};
}



// Shapes between planes.
void
test_exact()
{
  print() << "Exact" << std::endl;
  const auto check_2d = [](const std::string  &shape,
                           const double        volume,
                           const Tensor<1, 2> &center,
                           const double        inertia,
                           const double        area) {
    for (const unsigned int n : {2, 5})
      {
        const auto error = errors<2>(integrate<2>(fitted(shape, n), {{7, 8}}),
                                     volume,
                                     center,
                                     inertia,
                                     area);
        check("  " + shape + ": body", error.first, 1e-13);
        // On faces of cells points move into them by 1e-9.
        check("  " + shape + ": surface", error.second, 3e-9);
      }
  };
  const auto of_box = [](const double a, const double b, const Point<2> &c) {
    return a * b * (c.square() + (a * a + b * b) / 12.);
  };
  check_2d("box(0.1, 0.2, 0.83, 1.25)",
           0.73 * 1.05,
           Point<2>(0.465, 0.725),
           of_box(0.73, 1.05, {0.465, 0.725}),
           2. * (0.73 + 1.05));
  check_2d("x > 1/7 & x < 6/7 & y < 9/8 & 3/4 < 2 * y",
           5. / 7. * 0.75,
           Point<2>(0.5, 0.75),
           of_box(5. / 7., 0.75, {0.5, 0.75}),
           2. * (5. / 7. + 0.75));
  check_2d("intersection(half_space(0.6, 0.8, 1.2), half_space(-3, -4, -3.5), "
           "half_space(0.8, -0.6, 0.2), half_space(-0.8, 0.6, 0.3))",
           0.25,
           Point<2>(0.53, 0.79),
           of_box(0.5, 0.5, {0.53, 0.79}),
           2.);
  check_2d("difference(box(0.1, 0.2, 0.83, 1.25), box(0.3, 0.4, 0.5, 1))",
           0.73 * 1.05 - 0.12,
           (0.73 * 1.05 * Point<2>(0.465, 0.725) - 0.12 * Point<2>(0.4, 0.7)) /
             (0.73 * 1.05 - 0.12),
           of_box(0.73, 1.05, {0.465, 0.725}) - of_box(0.2, 0.6, {0.4, 0.7}),
           2. * (0.73 + 1.05 + 0.8));

  // A corner of a cube.
  const double a = 0.6;
  const auto   sum =
    integrate<3>(fitted("intersection(box(0.1, 0.2, 0.3, 0.9, 1.2, 1.3), "
                        "half_space(1, 1, 1, 1.2))",
                        3),
                 {{5, 6, 4}});
  const auto error =
    errors<3>(sum,
              a * a * a / 6.,
              Point<3>(0.1, 0.2, 0.3) + a / 4. * Point<3>(1., 1., 1.),
              sum.inertia,
              a * a * (1.5 + 0.5 * std::sqrt(3.)));
  check("  corner: body", error.first, 1e-13);
  check("  corner: surface", error.second, 3e-9);
}



// Orders with n points per direction; TABLE=1 in the environment shows them.
template <int dim>
void
test_orders(const std::string               &shape,
            const double                     volume,
            const Tensor<1, dim>            &center,
            const double                     inertia,
            const double                     area,
            const std::vector<unsigned int> &cells,
            const std::vector<unsigned int> &numbers,
            const double                     least)
{
  print() << shape << std::endl;
  for (const unsigned int n : numbers)
    {
      std::pair<double, double> last;
      for (const unsigned int c : cells)
        {
          const auto error =
            errors(integrate<dim>(fitted(shape, n), cube<dim>(c)),
                   volume,
                   center,
                   inertia,
                   area);
          if (c != cells[0])
            {
              const double ratio = std::log(double(c) / cells[0]);
              const double body  = std::log(last.first / error.first) / ratio;
              const double surface =
                std::log(last.second / error.second) / ratio;
              if (std::getenv("TABLE"))
                print() << "| " << n << " | " << last.first << " "
                        << error.first << " | " << body << " | " << last.second
                        << " " << error.second << " | " << surface << " |"
                        << std::endl;
              check("  n = " + std::to_string(n) + ", order",
                    2. * n + least - body,
                    0.);
            }
          last = error;
        }
    }
}



void
test_all_orders()
{
  const Point<2> c(0.5, 0.71);
  const double   R = 0.41, r = 0.2;
  const auto     polar = [&](const double radius) {
    return pi * radius * radius * (c.square() + 0.5 * radius * radius);
  };
  test_orders<2>("ball(0.5, 0.71, 0.41)",
                 pi * R * R,
                 c,
                 polar(R),
                 2. * pi * R,
                 {8, 16},
                 {2, 3, 4, 5},
                 0.);
  test_orders<2>("level_set((x - 0.5)^2 + (y - 0.71)^2 - 0.41^2)",
                 pi * R * R,
                 c,
                 polar(R),
                 2. * pi * R,
                 {8, 16},
                 {3},
                 0.);
  test_orders<2>("difference(ball(0.5, 0.71, 0.41), ball(0.5, 0.71, 0.2))",
                 pi * (R * R - r * r),
                 c,
                 polar(R) - polar(r),
                 2. * pi * (R + r),
                 {16, 32},
                 {2, 3, 4, 5},
                 0.);
  test_orders<2>("difference(box(0.05, 0.2, 0.93, 1.25), ball(0.5, 0.71, 0.2))",
                 0.88 * 1.05 - pi * r * r,
                 (0.88 * 1.05 * Point<2>(0.49, 0.725) - pi * r * r * c) /
                   (0.88 * 1.05 - pi * r * r),
                 0.88 * 1.05 *
                     (Point<2>(0.49, 0.725).square() +
                      (0.88 * 0.88 + 1.05 * 1.05) / 12.) -
                   polar(r),
                 2. * (0.88 + 1.05) + 2. * pi * r,
                 {16, 32},
                 {2, 3, 4, 5},
                 0.);
  const double   ball = 4. / 3. * pi * R * R * R;
  const Point<3> b(0.5, 0.71, 0.9);
  test_orders<3>("ball(0.5, 0.71, 0.9, 0.41)",
                 ball,
                 b,
                 ball * (b.square() + 0.6 * R * R),
                 4. * pi * R * R,
                 {6, 12},
                 {2, 3},
                 -1.);
  const double   height = 1.4;
  const Point<3> m(0.5, 0.71, 1.);
  test_orders<3>("cylinder(0.5, 0.71, 0.3, 0.5, 0.71, 1.7, 0.41)",
                 pi * R * R * height,
                 m,
                 pi * R * R * height *
                   (m.square() + 0.5 * R * R + height * height / 12.),
                 2. * pi * R * (R + height),
                 {6, 12},
                 {2, 3},
                 -1.);
}



// Curved surfaces that meet.
void
test_edges()
{
  print() << "Edges" << std::endl;
  const double r = 0.3, h = 0.125, angle = std::acos(h / r);
  const auto   lens =
    integrate<2>(fitted("union(ball(0.4, 0.6, 0.3), ball(0.65, 0.6, 0.3))", 5),
                 {{8, 9}});
  const double volume =
    2. * (pi * r * r - r * r * angle + h * std::sqrt(r * r - h * h));
  check("  union of disks: body", std::abs(lens.volume / volume - 1.), 1e-7);
  check("  union of disks: surface",
        std::abs(lens.area / (4. * r * (pi - angle)) - 1.),
        1e-6);

  const double length = std::sqrt(1.08);
  const auto   tilted =
    integrate<3>(fitted("cylinder(0.4, 0.6, 0.5, 0.6, 0.8, 1.5, 0.2)", 2),
                 {{8, 8, 8}});
  const auto error = errors<3>(tilted,
                               pi * 0.04 * length,
                               Point<3>(0.5, 0.7, 1.),
                               tilted.inertia,
                               2. * pi * 0.2 * (0.2 + length));
  if (std::getenv("TABLE"))
    print() << "| 2 | " << error.first << " | " << error.second << " |"
            << std::endl;
  check("  tilted cylinder: body", error.first, 5e-4);
  check("  tilted cylinder: surface", error.second, 2e-3);
}



void
test_placement()
{
  print() << "Placement" << std::endl;
  // A lattice inside, and the same points at the boundary.
  auto       placement = fitted("ball(0.5, 0.71, 0.41)", 3);
  const auto gauss     = integrate<2>(placement, {{12, 12}});
  placement.placement  = Placement::fitted_lattice;
  const auto lattice   = integrate<2>(placement, {{12, 12}});
  check("  fitted lattice: points", gauss.n_points == lattice.n_points);
  check("  fitted lattice: volume",
        std::abs(lattice.volume / gauss.volume - 1.),
        1e-13);

  // The part outside of the grid is cut off.
  placement         = fitted("ball(0, 0, 0.9)", 4);
  placement.clip    = true;
  const auto corner = integrate<2>(placement, {{10, 10}});
  check("  clipped: volume",
        std::abs(corner.volume / (pi * 0.2025) - 1.),
        1e-9);
  check("  clipped: area", std::abs(corner.area / (0.45 * pi) - 1.), 2e-8);

  // Formulas of either kind are the same bodies for points of a lattice.
  placement.shape       = "(x - 0.5)^2 + (y - 0.71)^2 < 0.41^2";
  placement.placement   = Placement::equidistant;
  const auto comparison = integrate<2>(placement, {{12, 12}});
  placement.shape       = "level_set((x - 0.5)^2 + (y - 0.71)^2 - 0.41^2)";
  check("  level_set()",
        integrate<2>(placement, {{12, 12}}).n_points == comparison.n_points &&
          comparison.n_points > 0.);

  // The disks of benchmark B5.
  double energy = 0.;
  for (const char *disk : {"ball(0.2, 0.2, 0.2)", "ball(0.8, 0.8, 0.2)"})
    energy +=
      0.5 * 1000. * 0.02 * integrate<2>(fitted(disk, 3), {{20, 30}}).volume;
  print() << "  kinetic energy of the disks of B5: " << std::fixed
          << std::setprecision(4) << energy << " J" << std::endl;
  check("  disks of B5", std::abs(energy - 0.8 * pi), 5e-6);
}



void
print_error(const std::function<void(PointPlacement &)> &set)
{
  PointPlacement placement = fitted("ball(0.5, 0.71, 0.41)", 2);
  set(placement);
  std::string message = "nothing is wrong";
  try
    {
      integrate<2>(placement, {{8, 8}});
    }
  catch (const std::exception &error)
    {
      message = message_of(error);
      // Each process has its own.
      message = message.substr(0, message.find(", for instance"));
    }
  print() << "  " << message << std::endl;
}



void
test_errors()
{
  print() << "Errors" << std::endl;
  for (const std::string shape : {"if(x < 0.5, 1, 0)",
                                  "x < 0.5 ? y < 0.5 : 0",
                                  "sin(x)",
                                  "x == y",
                                  "0.1 < x < 0.9",
                                  "union(ball(0.5, 0.5, 0.3), 1)",
                                  "ball(x, 0.5, 0.2)",
                                  "level_set(x - 0.5, y)",
                                  "box(0.5, 0.5, 1.01, 1)"})
    print_error([&](PointPlacement &placement) { placement.shape = shape; });
  print_error([](PointPlacement &placement) { placement.jitter = 0.5; });
  print_error([](PointPlacement &placement) {
    placement.shape = "ball(0.5, 0.5, 0.500001)";
  });
}



void
test_main()
{
  test_exact();
  test_all_orders();
  test_edges();
  test_placement();
  test_errors();
}

// SPDX-License-Identifier: LGPL-2.1-or-later

// Points that follow the boundary of a shape, and points on it: volumes,
// centres, moments of inertia and areas, exact or with their orders, and what
// is refused.

#include <greville/particles/fitted_points.h>

#include <chrono>
#include <tests.h>

// Integrals over a body and over its surface: of 1, x, |x|^2; of the normal and
// of x . n / dim.
template <int dim>
struct Integrals
{
  double         volume = 0., inertia = 0., area = 0., divergence = 0.;
  Tensor<1, dim> center, normal;
  double         n_points = 0, n_surface_points = 0;
};



template <int dim>
Integrals<dim>
integrate(const std::string &shape,
          const unsigned int n_cells,
          const unsigned int n,
          const bool         clip      = false,
          const std::string &placement = "fitted")
{
  Box<dim>               box(cube<dim>(n_cells));
  const SplineSpace<dim> space(box.mesh, 2);
  PointPlacement         parameters;
  parameters.shape                = shape;
  parameters.clip                 = clip;
  parameters.points_per_direction = {n};
  parameters.placement            = placement;
  Integrals<dim> sums;
  bool           ok = true;
  for (const auto &point : place_points(parameters, "Body a", space))
    {
      sums.volume += point.volume;
      sums.inertia += point.volume * point.x.norm_square();
      sums.center += point.volume * point.x;
      sums.n_points += 1;
      ok = ok && point.volume > 0.;
    }
  check(shape + ": positive volumes", ok);
  for (const auto &point : place_surface_points(parameters, "Body a", space))
    {
      sums.area += point.area;
      sums.normal += point.area * point.normal;
      sums.divergence += point.area * (point.x * point.normal) / dim;
      sums.n_surface_points += 1;
    }
  for (double *sum : {&sums.volume,
                      &sums.inertia,
                      &sums.area,
                      &sums.divergence,
                      &sums.n_points,
                      &sums.n_surface_points})
    *sum = Utilities::MPI::sum(*sum, MPI_COMM_WORLD);
  sums.center = Utilities::MPI::sum(sums.center, MPI_COMM_WORLD);
  sums.normal = Utilities::MPI::sum(sums.normal, MPI_COMM_WORLD);
  return sums;
}

int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const auto                       run = [&](auto                      d,
                       const std::string        &shape,
                       const double              volume,
                       const double              area,
                       std::vector<unsigned int> cells,
                       std::vector<unsigned int> ns = {2, 3, 4, 5}) {
    constexpr int dim = decltype(d)::value;
    std::cout << shape << std::endl;
    for (const unsigned int n : ns)
      for (const unsigned int c : cells)
        {
          const auto   t0 = std::chrono::steady_clock::now();
          const auto   s = integrate<dim>(shape, c, n);
          const double t =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - t0)
              .count();
          std::cout << "  n " << n << " cells " << c << " V "
                    << s.volume / volume - 1. << " A " << s.area / area - 1.
                    << " N " << s.normal.norm() << " div "
                    << s.divergence / volume - 1. << " points " << s.n_points
                    << " " << s.n_surface_points << " s " << t << std::endl;
        }
  };
  const double                   pi = numbers::PI;
  std::integral_constant<int, 2> two;
  std::integral_constant<int, 3> three;
  run(
    two, "ball(0.5, 0.71, 0.41)", pi * 0.41 * 0.41, 2 * pi * 0.41, {4, 8, 16});
  run(two,
      "difference(ball(0.5, 0.71, 0.41), ball(0.5, 0.71, 0.2))",
      pi * (0.41 * 0.41 - 0.04),
      2 * pi * 0.61,
      {4, 8, 16});
  run(two, "box(0.1, 0.2, 0.83, 1.25)", 0.73 * 1.05, 2 * (0.73 + 1.05), {4, 8});
  run(
    two, "box(0.25, 0.375, 0.75, 1.5)", 0.5 * 1.125, 2 * (0.5 + 1.125), {4, 8});
  run(two,
      "difference(box(0.1, 0.2, 0.83, 1.25), ball(0.5,0.7,0.2))",
      0.73 * 1.05 - pi * .04,
      2 * (0.73 + 1.05) + .4 * pi,
      {4, 8, 16});
  run(two,
      "difference(box(0.1, 0.2, 0.83, 1.25), ball(0.1,0.7,0.2))",
      0.73 * 1.05 - pi * .02,
      2 * (0.73 + 1.05) + .2 * pi - .4,
      {4, 8, 16});
  run(two,
      "intersection(half_space(0.6,0.8,1.2), half_space(-0.6,-0.8,-0.7), "
      "half_space(0.8,-0.6,0.4), half_space(-0.8,0.6,0.1))",
      0.25,
      2,
      {4, 8});
  run(two,
      "union(ball(0.4, 0.6, 0.3), ball(0.65, 0.6, 0.3))",
      2 * (pi * 0.09 - 0.09 * std::acos(0.125 / 0.3) +
           0.125 * std::sqrt(0.09 - 0.125 * 0.125)),
      4 * 0.3 * (pi - std::acos(.125 / .3)),
      {4, 8});
  run(two,
      "(x-0.5)^2+(y-0.71)^2 < 0.41^2",
      pi * 0.41 * 0.41,
      2 * pi * 0.41,
      {4, 8});
  run(three,
      "ball(0.5, 0.71, 0.9, 0.41)",
      4. / 3 * pi * 0.41 * 0.41 * 0.41,
      4 * pi * 0.41 * 0.41,
      {4, 8},
      {2, 3, 4});
  run(three,
      "cylinder(0.5, 0.71, 0.3, 0.5, 0.71, 1.7, 0.41)",
      pi * 0.41 * 0.41 * 1.4,
      2 * pi * 0.41 * (1.4 + .41),
      {4, 8},
      {2, 3});
  run(three,
      "box(0.1, 0.2, 0.3, 0.8, 0.9, 1.7)",
      0.7 * 0.7 * 1.4,
      2 * (.49 + 2 * .98),
      {4},
      {2, 3});
  run(three,
      "cylinder(0.4, 0.6, 0.5, 0.6, 0.8, 1.5, 0.2)",
      pi * 0.04 * std::sqrt(1.08),
      2 * pi * 0.2 * (std::sqrt(1.08) + .2),
      {4, 8},
      {2, 3});
  run(
    three,
    "intersection(box(0.05,0.05,0.05,0.95,1.4,1.9),half_space(0.6,0.8,1,1.2))",
    0,
    0,
    {4},
    {2});
}

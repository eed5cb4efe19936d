// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks bodies from shapes and files: volumes, points, stresses,
// displacements, and error messages.

#include <greville/materials/linear_elastic.h>
#include <greville/materials/newtonian_fluid.h>
#include <greville/points/body.h>
#include <greville/points/point_transport.h>

#include "points.h"
#include <fstream>

// A grid on [0, 1] x [0, 1.5] (x [0, 2]) and a body on it.
template <int dim>
class Made
{
public:
  using Layout = PointLayout<dim>;

  Made(const MultiIndex<dim>                       &cells,
       const std::function<void(BodyParameters &)> &set,
       const Tensor<1, dim>                        &gravity = Tensor<1, dim>(),
       const MPI_Comm                               comm    = MPI_COMM_WORLD)
    : box(cells, comm)
    , space(box.mesh, 2)
  {
    material.density = 2000.;
    material.reinit("Material");
    set(parameters);
    body.name       = "a";
    body.parameters = &parameters;
    body.material   = &material;
    left =
      make_points(body,
                  space,
                  gravity,
                  make_layout<dim>(material.state_names().size(), true, true));
  }

  double
  volume() const
  {
    return integrate([](const auto &) { return 1.; });
  }

  // Of f over the volume that points have.
  double
  integrate(const std::function<double(ConstPointRef<dim>)> &f) const
  {
    double sum = 0.;
    body.points.for_each([&](const unsigned int, const auto p) {
      sum += p.volume0() * p.J() * f(p);
    });
    return Utilities::MPI::sum(sum, space.communicator());
  }

  double
  largest(const std::function<double(ConstPointRef<dim>)> &f) const
  {
    double result = 0.;
    body.points.for_each([&](const unsigned int, const auto p) {
      const double value = f(p);
      result = std::max(result, value == value ? std::abs(value) : 1e300);
    });
    return Utilities::MPI::max(result, space.communicator());
  }

  bool
  in_their_cells() const
  {
    bool ok = true;
    body.points.for_each([&](const unsigned int cell, const auto p) {
      ok &=
        body.points.space().contains(cell,
                                     p.basis_position(body.points.layout()));
    });
    return on_all(ok);
  }

  Box<dim>                  box;
  SplineSpace<dim>          space;
  LinearElastic             material;
  BodyParameters            parameters;
  Body<dim>                 body;
  std::vector<unsigned int> left;
};



template <int dim>
double
volume_of(const unsigned int n, const std::string &shape, const bool clip)
{
  const Made<dim> made(cube<dim>(n), [&](BodyParameters &body) {
    body.shape = shape;
    body.clip  = clip;
  });
  return made.volume();
}



// The volume on a grid, and that the error goes to zero.
template <int dim>
void
check_volume(const std::string &shape, const double exact, const bool clip)
{
  const unsigned int n = dim == 2 ? 16 : 6;
  const double coarse  = std::abs(volume_of<dim>(n, shape, clip) / exact - 1.);
  const double fine =
    std::abs(volume_of<dim>((dim == 2 ? 4 : 3) * n, shape, clip) / exact - 1.);
  check("  " + shape + ", coarse", coarse, dim == 2 ? 0.03 : 0.1);
  check("  " + shape + ", fine", fine, dim == 2 ? 0.003 : 0.02);
}



void
test_volumes()
{
  const double pi = numbers::PI;
  print() << "2D" << std::endl;
  // Faces lie between points: exact.
  check("  box",
        std::abs(volume_of<2>(8, "box(0.125, 0.375, 0.75, 1.5)", false) /
                   (0.625 * 1.125) -
                 1.),
        1e-14);
  check("  half of the grid",
        std::abs(volume_of<2>(8, "half_space(0, 2, 1.5)", true) / 0.75 - 1.),
        1e-14);
  check("  the grid, clipped",
        std::abs(volume_of<2>(8, "1", true) / 1.5 - 1.),
        1e-14);
  check_volume<2>("ball(0.5, 0.7, 0.4)", 0.16 * pi, false);
  check_volume<2>("half_space(1, 1, 1)", 0.5, true);
  check_volume<2>("half_space(-1, -1, -1.5)", 0.5, true);
  check_volume<2>("y > 3/32 && y < 0.6 + 0.2 * sin(2 * pi * x) && x < 7/8 && x "
                  "> 1/8",
                  0.75 * (0.6 - 3. / 32.),
                  false);

  // Sets: what is counted twice.
  const std::string a = "ball(0.5, 0.7, 0.4)";
  const std::string b = "box(0.4, 0.1, 0.95, 0.8)";
  const double      A = volume_of<2>(20, a, false);
  const double      B = volume_of<2>(20, b, false);
  const double      both =
    volume_of<2>(20, "intersection(" + a + ", " + b + ")", false);
  const double any = volume_of<2>(20, "union(" + a + ", " + b + ")", false);
  const double rest =
    volume_of<2>(20, "difference(" + a + ", " + b + ")", false);
  const double nothing_else =
    volume_of<2>(20,
                 "difference(" + a + ", " + b + ", half_space(1, 0, 0.3))",
                 false);
  const double same =
    volume_of<2>(20, "(x - 0.5)^2 + (y - 0.7)^2 <= 0.16", false);
  const double logic = volume_of<2>(20, a + " && " + b + " == 0", false);
  check("  intersection", both > 0.1 && both < 0.9 * std::min(A, B));
  check("  union", std::abs(any - (A + B - both)), 1e-14);
  check("  difference", std::abs(rest - (A - both)), 1e-14);
  check("  difference of three",
        nothing_else < rest - 0.05 && nothing_else > 0.01);
  check("  formula of a ball", std::abs(same - A), 1e-14);
  check("  formula with shapes", std::abs(logic - rest), 1e-14);

  print() << "3D" << std::endl;
  check("  box",
        std::abs(volume_of<3>(4, "box(0.25, 0, 0.5, 0.75, 0.75, 1)", false) /
                   (0.5 * 0.75 * 0.5) -
                 1.),
        1e-14);
  check_volume<3>("ball(0.5, 0.7, 0.9, 0.4)", 4. / 3. * pi * 0.064, false);
  check_volume<3>("cylinder(0.5, 0.7, 0.3, 0.5, 0.7, 1.8, 0.4)",
                  0.16 * pi * 1.5,
                  false);
  // The axis may have any direction.
  check_volume<3>("cylinder(0.5, 0.4, 0.5, 0.5, 1.1, 1.5, 0.35)",
                  0.1225 * pi * std::sqrt(0.49 + 1.),
                  false);
  check_volume<3>("half_space(0, 1, 1, 1)", 0.5, true);
}



void
test_placement()
{
  print() << "Placement" << std::endl;
  using Layout = PointLayout<2>;
  {
    // Degrees 2 n - 1
    const Made<2> made({{3, 4}}, [](BodyParameters &body) {
      body.shape                = "box(0, 0, 1, 1.5)";
      body.placement            = Placement::gauss;
      body.points_per_direction = {3, 2};
    });
    check("  Gauss points",
          std::abs(made.integrate([](const auto p) {
            return std::pow(p.position(0), 5) * std::pow(p.position(1), 3);
          }) / (1. / 6. * std::pow(1.5, 4) / 4.) -
                   1.),
          1e-13);
    check("  and no more",
          std::abs(made.integrate([](const auto p) {
            return std::pow(p.position(1), 4);
          }) / (std::pow(1.5, 5) / 5.) -
                   1.) > 1e-5);
    print() << "  points " << made.body.n_points << std::endl;
  }
  {
    const Made<3> made({{2, 3, 2}}, [](BodyParameters &body) {
      body.shape                = "box(0, 0, 0, 1, 1.5, 2)";
      body.placement            = Placement::gauss;
      body.points_per_direction = {2};
    });
    check("  Gauss points in 3D",
          std::abs(made.integrate([](const auto p) {
            return std::pow(p.position(0) * p.position(1) * p.position(2), 3);
          }) / (1. / 64. * std::pow(3., 4)) -
                   1.),
          1e-13);
  }

  // Equal distances and volumes; the numbers of a point.
  const Made<2> even({{3, 4}}, [](BodyParameters &body) {
    body.shape                = "box(0, 0, 1, 1.5)";
    body.points_per_direction = {2, 3};
    body.velocity             = "x + 2 * y; x * y";
  });
  check("  equal distances",
        even.largest([](const auto p) {
          const double i = p.position(0) * 6. - 0.5,
                       j = p.position(1) * 8. - 0.5;
          return std::max(std::abs(i - std::round(i)),
                          std::abs(j - std::round(j)));
        }),
        1e-13);
  const unsigned int affine = even.body.points.layout().first("affine");
  check("  volume, mass, J, F, stress, reference, velocity with its gradient",
        even.largest([&](const auto p) {
          double error = std::abs(p.volume0() * 72. - 1.5);
          error = std::max(error, std::abs(p.mass() - 2000. * p.volume0()));
          error = std::max(error, std::abs(p.J() - 1.));
          error =
            std::max(error,
                     (p.F() - Tensor<2, 3>(unit_symmetric_tensor<3>())).norm());
          for (unsigned int k = 0; k < 4; ++k)
            error = std::max(error, std::abs(p.stress(k)));
          for (unsigned int d = 0; d < 2; ++d)
            error = std::max(error, std::abs(p.reference(d) - p.position(d)));
          const double x = p.position(0), y = p.position(1);
          error = std::max(error, std::abs(p.velocity(0) - x - 2. * y));
          error = std::max(error, std::abs(p.velocity(1) - x * y));
          const std::array<double, 4> gradient = {{1., 2., y, x}};
          for (unsigned int k = Layout::n_fixed;
               k < even.body.points.layout().size;
               ++k)
            error = std::max(error,
                             std::abs(p[k] - (k >= affine && k < affine + 4
                                                ? gradient[k - affine]
                                                : 0.)));
          return error;
        }),
        1e-12);
  // Ids are different.
  std::vector<double> counts(even.body.n_points, 0.);
  bool                ids = true;
  for (const auto &point : by_id(even.body.points))
    if (point.first < counts.size())
      counts[point.first] += 1.;
    else
      ids = false;
  Utilities::MPI::sum(counts, MPI_COMM_WORLD, counts);
  for (const double count : counts)
    ids &= count == 1.;
  check("  ids", on_all(ids && even.left.empty()));

  // Jitter: bounded, from the seed, the same on one process.
  for (const unsigned int seed : {1, 2})
    {
      const auto set = [&](BodyParameters &body) {
        body.shape                = "ball(0.5, 0.7, 0.45)";
        body.points_per_direction = {2, 3};
        body.jitter               = 0.4;
        body.seed                 = seed;
      };
      const Made<2> made({{8, 9}}, set);
      const Made<2> again({{8, 9}}, set);
      const Made<2> own({{8, 9}}, set, Tensor<1, 2>(), MPI_COMM_SELF);
      const auto    all = by_id(own.body.points);
      bool          same =
        made.body.n_points == all.size() && own.body.n_points == all.size();
      for (const auto &point : by_id(made.body.points))
        same &=
          all.count(point.first) == 1 && all.at(point.first) == point.second;
      same &= difference(made.body.points, again.body.points) == 0.;
      check("  jitter: any number of processes", on_all(same));
      double largest = 0., inside = 0.;
      largest = made.largest([](const auto p) {
        double distance = 0.;
        for (unsigned int d = 0; d < 2; ++d)
          {
            // In distances of points
            const double t = p.position(d) * (d == 0 ? 16. : 18.) - 0.5;
            distance       = std::max(distance, std::abs(t - std::round(t)));
          }
        return distance;
      });
      inside  = made.largest([](const auto p) {
        return std::pow(p.position(0) - 0.5, 2) +
               std::pow(p.position(1) - 0.7, 2);
      });
      check("  jitter: bound", largest, 0.2);
      check("  jitter: reached", largest > 0.19);
      check("  jitter: inside of the shape", inside, 0.2025);
      double checksum = 0.;
      made.body.points.for_each([&](const unsigned int, const auto p) {
        for (unsigned int d = 0; d < 2; ++d)
          checksum += std::cos(p.id() + d) * p.position(d);
      });
      print() << "  jitter: points " << made.body.n_points << ", checksum "
              << std::fixed << std::setprecision(6)
              << Utilities::MPI::sum(checksum, MPI_COMM_WORLD)
              << std::defaultfloat << std::endl;
    }
  const double shift = Made<2>({{8, 9}}, [](BodyParameters &body) {
                         body.shape  = "box(0, 0, 1, 1.5)";
                         body.jitter = 1.;
                       }).volume();
  check("  jitter: volume", std::abs(shift - 1.5), 1e-14);
}



void
test_stress()
{
  print() << "Stress" << std::endl;
  // K0: depth below a surface, against gravity along -y, +x and -z.
  const auto check_K0 = [](const auto        &made,
                           const std::string &name,
                           const unsigned int axis,
                           const auto        &depth) {
    using Layout = typename std::decay_t<decltype(made)>::Layout;
    check("  K0, " + name,
          made.largest([&](const auto p) {
            double error = 0.;
            for (unsigned int d = 0; d < 3; ++d)
              error =
                std::max(error,
                         std::abs(p.stress(d) + 2000. * 10. * depth(p) *
                                                  (d == axis ? 1. : 0.5)) /
                           2e4);
            for (unsigned int k = 3; k < Layout::n_stress; ++k)
              error = std::max(error, std::abs(p.stress(k)));
            return error;
          }),
          1e-13);
  };
  Tensor<1, 2> down;
  down[1] = -10.;
  const Made<2> slope(
    {{4, 6}},
    [](BodyParameters &body) {
      body.shape   = "half_space(-0.2, 1, 1.0)";
      body.clip    = true;
      body.K0      = 0.5;
      body.surface = "1.01 + 0.2 * x";
    },
    down);
  check_K0(slope, "-y", 1, [](const auto p) {
    return 1.01 + 0.2 * p.position(0) - p.position(1);
  });
  check("    volume is that of the shape",
        slope.largest(
          [](const auto p) { return p.volume0() * p.J() * 96. / 1.5 - 1.; }),
        1e-13);
  check("    J is det F, and below 1",
        slope.largest([](const auto p) {
          const double J = p.J();
          return J < 1. ? J - determinant(p.F()) : 1.;
        }),
        1e-14);
  check("    mass is density times volume",
        slope.largest(
          [](const auto p) { return p.mass() / (2000. * 1.5 / 96.) - 1.; }),
        1e-14);
  Tensor<1, 2> right;
  right[0] = 10.;
  check_K0(Made<2>(
             {{4, 6}},
             [](BodyParameters &body) {
               body.shape   = "box(0.25, 0, 1, 1.5)";
               body.K0      = 0.5;
               body.surface = "0.25";
             },
             right),
           "+x",
           0,
           [](const auto p) { return p.position(0) - 0.25; });
  Tensor<1, 3> below;
  below[2] = -10.;
  check_K0(Made<3>(
             {{2, 2, 4}},
             [](BodyParameters &body) {
               body.shape   = "box(0, 0, 0, 1, 1.5, 1.5)";
               body.K0      = 0.5;
               body.surface = "1.3";
             },
             below),
           "-z",
           2,
           // Above the surface there is none.
           [](const auto p) { return std::max(0., 1.3 - p.position(2)); });

  const Made<3> given({{2, 2, 2}}, [](BodyParameters &body) {
    body.shape  = "box(0, 0, 0, 1, 1.5, 2)";
    body.stress = "1e4 * x; 2e4 * y; 3e4 * z; 1e4 * y; 2e4; 1e4 * x * z";
  });
  check("  formulas",
        given.largest([](const auto p) {
          const double x = p.position(0), y = p.position(1), z = p.position(2);
          const double stress[6] = {
            1e4 * x, 2e4 * y, 3e4 * z, 1e4 * y, 2e4, 1e4 * x * z};
          double error = 0.;
          for (unsigned int k = 0; k < 6; ++k)
            error = std::max(error, std::abs(p.stress(k) - stress[k]) / 1e4);
          return error;
        }),
        1e-13);
  // F is that of the stress: the material gives it back.
  check("    and F belongs to it",
        given.largest([&](const auto p) {
          MaterialPoint state;
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              state.F[i][j] = p[PointLayout<3>::F + 3 * i + j];
          state.J         = p.J();
          state.increment = unit_symmetric_tensor<3>();
          given.material.update(ArrayView<MaterialPoint>(&state, 1));
          double error = 0.;
          for (unsigned int d = 0; d < 3; ++d)
            error =
              std::max(error, std::abs(state.stress[d][d] - p.stress(d)) / 1e6);
          error =
            std::max(error, std::abs(state.stress[0][2] - p.stress(4)) / 1e6);
          error =
            std::max(error, std::abs(state.stress[1][2] - p.stress(5)) / 1e6);
          return error;
        }),
        1e-13);
}



void
test_displacement()
{
  print() << "Displacement" << std::endl;
  using Layout = PointLayout<2>;
  // It moves points over several cells.
  Made<2> made({{8, 8}}, [](BodyParameters &body) {
    body.shape = "box(0, 0, 0.5, 0.75)";
    body.displacement =
      "0.4 + 0.1 * x + 0.2 * x * y; 0.3 - 0.1 * y + 0.1 * x^3";
    body.velocity = "x; y";
  });
  check("  points lie in the cells of the shape",
        on_all(made.left == made.body.points.cells()) &&
          made.body.n_points == 64);
  PointTransport<2> transport;
  transport.reinit(made.space);
  const auto result = transport.move(made.body.points, made.left);
  check("  and are moved",
        made.in_their_cells() &&
          Utilities::MPI::sum<unsigned int>(made.body.points.n_points(),
                                            MPI_COMM_WORLD) == 64 &&
          Utilities::MPI::sum<unsigned int>(result.n_moved, MPI_COMM_WORLD) ==
            64);
  const auto F_of = [](const auto p) {
    const double X = p.reference(0), Y = p.reference(1);
    Tensor<2, 3> F = unit_symmetric_tensor<3>();
    F[0][0] += 0.1 + 0.2 * Y;
    F[0][1] += 0.2 * X;
    F[1][0] += 0.3 * X * X;
    F[1][1] += -0.1;
    return F;
  };
  check("  x is X + u, velocities are those of X",
        made.largest([](const auto p) {
          const double X = p.reference(0), Y = p.reference(1);
          return std::abs(p.position(0) - X - (0.4 + 0.1 * X + 0.2 * X * Y)) +
                 std::abs(p.position(1) - Y -
                          (0.3 - 0.1 * Y + 0.1 * X * X * X)) +
                 std::abs(p.velocity(0) - X) + std::abs(p.velocity(1) - Y);
        }),
        1e-14);
  check("  F is 1 + grad u",
        made.largest([&](const auto p) {
          const auto F = F_of(p);
          return (p.F() - F).norm();
        }),
        1e-11);
  check("  J is det F",
        made.largest(
          [&](const auto p) { return p.J() - determinant(F_of(p)); }),
        1e-11);
  check("  the stress is that of F",
        made.largest([&](const auto p) {
          MaterialPoint state;
          state.F = F_of(p);
          state.J = determinant(state.F);
          made.material.update(ArrayView<MaterialPoint>(&state, 1));
          return ((p.stress() - state.stress).norm()) / 1e6;
        }),
        1e-11);
  check("  volume and mass of the shape",
        made.largest([](const auto p) {
          return std::abs(p.volume0() * 256. - 1.5) +
                 std::abs(p.mass() * 256. / 3000. - 1.);
        }),
        1e-13);

  // A viscous fluid is displaced once, not at a rate.
  NewtonianFluid   fluid;
  BodyParameters   parameters;
  ParameterHandler prm;
  fluid.declare(prm);
  prm.set("Viscosity", 1e3);
  fluid.reinit("Fluid");
  parameters.shape        = "box(0, 0, 0.5, 0.75)";
  parameters.displacement = "0.1 * y; 0";
  Body<2> body;
  body.name       = "fluid";
  body.parameters = &parameters;
  body.material   = &fluid;
  make_points(body, made.space, Tensor<1, 2>(), Layout(fluid.state_names()));
  double stress = 0., heat = 0., shear = 1.;
  body.points.for_each([&](const unsigned int, const auto p) {
    for (unsigned int k = 0; k < Layout::n_stress; ++k)
      stress = std::max(stress, std::abs(p.stress(k)));
    heat  = std::max(heat, std::abs(p[body.points.layout().state]));
    shear = std::min(shear, p.F(0, 1));
  });
  check("  a displacement of a fluid", max_all(0.1 - shear), 1e-9);
  check("    makes no viscous stress, Pa", max_all(stress), 1e-3);
  check("    and no heat, J / m^3", max_all(heat), 0.);
}



void
write(const std::string &name, const std::string &text)
{
  if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::ofstream(name) << text;
  MPI_Barrier(MPI_COMM_WORLD);
}



void
test_file()
{
  print() << "Points file" << std::endl;
  // Columns in any order, comments, empty lines.
  write("points.csv",
        "# a comment\n\nvolume, colour, y, x\n"
        "0.1, 1, 0.2, 0.3\n"
        "0.2, 2, 1.5, 1\n"
        "  # another\n"
        "0.3, 3, 0, 0\n\n"
        "4e-1, 4, 0.75, 0.5");
  const auto set = [](BodyParameters &body) {
    body.points_file = "points.csv";
    body.velocity    = "x; y";
  };
  const Made<2> made({{4, 4}}, set);
  print() << "  points " << made.body.n_points << ", volume " << made.volume()
          << std::endl;
  const double x[4] = {0.3, 1., 0., 0.5}, y[4] = {0.2, 1.5, 0., 0.75};
  check("  positions, volumes, masses, ids, velocities",
        made.largest([&](const auto p) {
          const unsigned int i = p.id();
          if (i >= 4)
            return 1.;
          return std::abs(p.position(0) - x[i]) +
                 std::abs(p.position(1) - y[i]) +
                 std::abs(p.volume0() - 0.1 * (i + 1)) +
                 std::abs(p.mass() - 200. * (i + 1)) +
                 std::abs(p.velocity(0) - x[i]) +
                 std::abs(p.velocity(1) - y[i]);
        }),
        1e-12);
  check("  cells", made.in_their_cells());
  const Made<2> own({{4, 4}}, set, Tensor<1, 2>(), MPI_COMM_SELF);
  check("  all ids", on_all(by_id(own.body.points).size() == 4));
}



template <int dim>
void
print_error(const std::function<void(BodyParameters &)> &set,
            const Tensor<1, dim> &gravity = Tensor<1, dim>())
{
  try
    {
      const Made<dim> made(cube<dim>(4), set, gravity);
      print() << "  accepted: FAILED" << std::endl;
    }
  catch (const std::exception &error)
    {
      // The same on all processes
      const std::string message = message_of(error);
      bool              same    = true;
      for (const auto &other :
           Utilities::MPI::all_gather(MPI_COMM_WORLD, message))
        same = same && other == message;
      // muParser's part differs between its versions.
      const auto formula = message.find(" is no function of ");
      print() << "  "
              << (formula == std::string::npos
                    ? message
                    : message.substr(0, message.find(':', formula)))
              << (same ? "" : " FAILED: not the same") << std::endl;
    }
}

template <int dim>
void
print_shape_error(const std::string &shape)
{
  print_error<dim>([&](BodyParameters &body) { body.shape = shape; });
}



void
test_errors()
{
  print() << "Errors" << std::endl;
  print_shape_error<2>("");
  print_shape_error<2>("ball(0.5, 0.5, 0.01)");
  print_shape_error<3>("intersection(box(0, 0, 0, 1, 1, 1), z > 1)");
  // Of one cell only, so that the point is always the same.
  print_error<2>([](BodyParameters &body) {
    body.shape                = "box(0.8, 0.8, 1.2, 1)";
    body.points_per_direction = {1};
  });
  print_error<3>([](BodyParameters &body) {
    body.shape                = "box(0.3, 0.4, -1, 0.4, 0.6, 0.4)";
    body.points_per_direction = {1};
  });
  print_shape_error<2>("box(0, 0, 1)");
  print_shape_error<2>("box(0, 0, 0, 1, 1, 1)");
  print_shape_error<3>("box(0, 0, 1, 1)");
  print_shape_error<2>("ball(0, 0, 0, 1)");
  print_shape_error<3>("half_space(0, 1, 1)");
  print_shape_error<2>("cylinder(0, 0, 0, 1, 1, 1, 1)");
  print_shape_error<2>("box(0, 0, 1, 1");
  print_shape_error<2>("z < 1");
  print_shape_error<2>("sphere(0, 0, 1)");
  const auto with_box = [](const std::function<void(BodyParameters &)> &set) {
    return [set](BodyParameters &body) {
      body.shape = "box(0, 0, 1, 1.5)";
      set(body);
    };
  };
  Tensor<1, 2> slanted, down;
  slanted[0] = slanted[1] = 7.;
  down[1]                 = -10.;
  print_error<2>(with_box([](BodyParameters &body) {
    body.points_per_direction = {2, 2, 2};
  }));
  print_error<2>(with_box([](BodyParameters &body) { body.velocity = "1"; }));
  print_error<2>(
    with_box([](BodyParameters &body) { body.stress = "1; 2; 3"; }));
  print_error<2>(with_box([](BodyParameters &body) {
                   body.stress = "1; 2; 3; 4";
                   body.K0     = 0.5;
                 }),
                 down);
  print_error<2>(with_box([](BodyParameters &body) {
    body.K0      = 0.5;
    body.surface = "1";
  }));
  print_error<2>(with_box([](BodyParameters &body) {
                   body.K0      = 0.5;
                   body.surface = "1";
                 }),
                 slanted);
  // A single point, so that it is always the same.
  print_error<2>([](BodyParameters &body) {
    body.shape                = "ball(0.6, 0.6, 0.1)";
    body.points_per_direction = {1};
    body.displacement         = "-2 * x; 0";
  });
  print_error<2>([](BodyParameters &body) {
    body.shape                = "ball(0.6, 0.6, 0.1)";
    body.points_per_direction = {1};
    body.stress               = "1e7; 1e7; 1e7; 0";
  });

  const auto with_file = [](const std::string &text) {
    write("wrong.csv", text);
    print_error<2>(
      [](BodyParameters &body) { body.points_file = "wrong.csv"; });
  };
  print_error<2>(
    with_box([](BodyParameters &body) { body.points_file = "missing.csv"; }));
  print_error<2>(
    [](BodyParameters &body) { body.points_file = "missing.csv"; });
  with_file("x, y\n0, 0\n");
  with_file("# points\nx, y, volume\n0.1, 0.2, 1e-3\n0.3, 0.2\n");
  with_file("x, y, volume\n0.1, a, 1e-3\n");
  with_file("x, y, volume\n0.1, 0.2, 0\n");
  with_file("x, y, volume\n0.1, 0.2, nan\n");
  with_file("x, y, volume\n0.1, 1.6, 1\n");
  with_file("x, y, volume\n");
  with_file("");
}



void
test_main()
{
  test_volumes();
  test_placement();
  test_stress();
  test_displacement();
  test_file();
  test_errors();
}

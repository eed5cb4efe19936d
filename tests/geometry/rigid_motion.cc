// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks rigid bodies that move and turn: rotations stay orthogonal and follow
// a constant spin exactly, maps between initial and current positions are
// inverse to each other, and velocities are difference quotients of positions.

#include <greville/geometry/rigid_motion.h>

#include <tests.h>

template <int dim>
RigidPosition<dim>
make_body()
{
  RigidPosition<dim> body;
  for (unsigned int d = 0; d < dim; ++d)
    {
      body.reference[d]    = 0.3 + 0.4 * d;
      body.displacement[d] = 0.2 - 0.5 * d;
      body.velocity[d]     = 1.3 - 0.7 * d;
    }
  for (unsigned int d = 0; d < (dim == 2 ? 1 : 3); ++d)
    body.spin[d] = 2.1 - 1.7 * d;
  return body;
}



template <int dim>
Tensor<2, dim>
unit()
{
  return unit_symmetric_tensor<dim>();
}



template <int dim>
void
test()
{
  const std::string  in   = std::to_string(dim) + "D, ";
  RigidPosition<dim> body = make_body<dim>();
  Point<dim>         X, x;
  for (unsigned int d = 0; d < dim; ++d)
    {
      X[d] = 1.1 - 0.9 * d;
      x[d] = X[d] + body.displacement[d];
    }
  check(in + "no rotation at first",
        current_position(body, X).distance(x),
        1e-15);

  // The same by one step and by many.
  RigidPosition<dim> at_once = body;
  const double       end     = 4.7;
  rotate(at_once, end);
  for (unsigned int step = 0; step < 1000; ++step)
    rotate(body, end / 1000);
  check(in + "rotation by 1000 steps",
        (body.rotation - at_once.rotation).norm(),
        1e-12);
  check(in + "columns are orthogonal",
        (transpose(body.rotation) * body.rotation - unit<dim>()).norm(),
        1e-14);
  check(in + "determinant", std::abs(determinant(body.rotation) - 1.), 1e-14);
  const Tensor<2, dim> there = rotation_matrix<dim>(end * body.spin);
  const Tensor<2, dim> back  = rotation_matrix<dim>(-end * body.spin);
  check(in + "rotation by one matrix", (there - body.rotation).norm(), 1e-12);
  check(in + "rotation and back", (there * back - unit<dim>()).norm(), 1e-14);
  check(in + "small rotation",
        std::abs((rotation_matrix<dim>(1e-6 * body.spin) - unit<dim>()).norm() /
                   1e-6 -
                 std::sqrt(2.) * body.spin.norm()),
        1e-9);

  check(in + "then and now",
        initial_position(body, current_position(body, X)).distance(X),
        1e-14);
  check(in + "now and then",
        current_position(body, initial_position(body, X)).distance(X),
        1e-14);

  // A central difference of the path of a point.
  const double step = 1e-4;
  const auto   at   = [&](const double t) {
    RigidPosition<dim> moved = body;
    moved.displacement += t * body.velocity;
    rotate(moved, t);
    return current_position(moved, X);
  };
  const Tensor<1, dim> quotient = (at(step) - at(-step)) / (2. * step);
  check(in + "velocity",
        (velocity_at(body, current_position(body, X)) - quotient).norm(),
        1e-6);
  check(in + "velocity of the reference point",
        (velocity_at(body, current_position(body, body.reference)) -
         body.velocity)
          .norm(),
        1e-14);
  print() << in << "velocity: " << std::fixed << std::setprecision(6)
          << velocity_at(body, X) << std::endl;
}



void
test_main()
{
  test<2>();
  test<3>();

  // A quarter of a turn counterclockwise, and one about z.
  RotationVector<2> angle;
  angle[0] = 0.5 * numbers::PI;
  check(
    "x to y in 2D",
    (rotation_matrix<2>(angle) * Point<2>(1., 0.) - Point<2>(0., 1.)).norm(),
    1e-15);
  RotationVector<3> about_z;
  about_z[2] = 0.5 * numbers::PI;
  check("x to y in 3D",
        (rotation_matrix<3>(about_z) * Point<3>(1., 0., 0.) -
         Point<3>(0., 1., 0.))
          .norm(),
        1e-15);
}

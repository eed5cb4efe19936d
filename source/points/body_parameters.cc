// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/base/parameters.h>
#include <greville/points/body.h>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  BodyParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Material", material)(
      "The name of the body's material.");
    add_formula(prm, "Shape", shape)(
      "The inside of the body: a formula of x, y (and z) in m that is true "
      "inside. Shapes are box(x0, y0, [z0,] x1, y1, [z1]), ball(x, y, [z,] "
      "radius), cylinder(x0, y0, z0, x1, y1, z1, radius), half_space(n_x, n_y, "
      "[n_z,] c) with n . x <= c, level_set(f) where the formula f is "
      "negative; "
      "union(...), intersection(...) and difference(a, b, ...) combine them.");
    add_parameter(prm, "Shape file", shape_file)(
      "Instead of a shape: a file, beside the parameter file, with a closed "
      "surface. 3D: a mesh of triangles whose normals point outwards (STL, "
      "PLY, "
      "OBJ); 2D: a CSV file with the vertices of a polygon in the columns x "
      "and "
      "y, of several where a column loop numbers them; those inside of others "
      "are holes.");
    add_parameter(prm, "Unit of shape file", shape_file_unit, Double(1e-12))(
      "The length of the unit in which the shape file is written: 0.001 for "
      "mm. "
      "Unit: m.");
    add_parameter(prm, "Clip at the grid", clip)(
      "What sticks out of the grid is cut off; an error otherwise.");
    add_parameter(prm, "Points file", points_file)(
      "Instead of a shape: points in a CSV file beside the parameter file, "
      "with "
      "a header and columns; lines with # are comments. scripts/points_to_csv "
      "makes one from a file of VTK. Columns: x, y (, z) in m, volume in m^3 "
      "(2D: m^2) or mass in kg; if they are there velocity_x, ..., stress_xx, "
      "stress_yy, stress_zz, stress_xy (, stress_xz, stress_yz), J or F_xx, "
      "F_xy, ..., displacement_x or reference_x, ..., density, and what the "
      "material keeps. 'Velocity', 'Stress' and 'K0' take the place of what a "
      "file has.");
    add_parameter(prm,
                  "Points per direction",
                  points_per_direction,
                  List(Integer(1, 12), 1, 3))(
      "Points per cell in each direction; one number for all. Unit: none.");
    add_choice(prm, "Placement", placement, placements)(
      "Points of a cell at equal distances with equal volumes, or on Gauss "
      "points with the volumes of Gauss weights, those that are inside. "
      "fitted: "
      "Gauss points of what of each cell is inside, which follow the boundary; "
      "fitted lattice: equal distances in cells wholly inside, fitted in those "
      "that the boundary cuts; for 'Grid/Order' >= 2 the stress near the "
      "boundary is then wrong by 0.2 to 9 %, even a uniform one.");
    add_parameter(prm, "Jitter", jitter, Double(0., 1.))(
      "Each point is moved at random by at most this part of half the distance "
      "between points. Unit: none.");
    add_formula(prm, "Displacement", displacement)(
      "Initial displacement from the positions of the shape: formulas of x, y "
      "(, z) separated by semicolons, which also give the deformation gradient "
      "and the stress; empty: none. Unit: m.");
    add_formula(prm, "Velocity", velocity)(
      "Initial velocity: formulas of the positions of the shape x, y (, z) "
      "separated by semicolons; empty: at rest. Unit: m / s.");
    add_formula(prm, "Stress", stress)(
      "Initial Cauchy stress: formulas of x, y (, z) for xx; yy; zz; xy (; xz; "
      "yz); empty: none. Unit: Pa.");
    add_parameter(prm, "K0", K0)(
      "Not negative: the initial stress is the weight of what lies above, -rho "
      "g depth, along gravity, and K0 times that across. Unit: none.");
    add_formula(prm, "Surface", surface)(
      "For K0: where the body ends against gravity, as the coordinate along "
      "the axis of gravity; a formula of x, y (, z). No point may lie beyond "
      "it by half a cell or more. Unit: m.");
  }
} // namespace greville

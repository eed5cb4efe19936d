// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/points/body.h>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  BodyParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Material", material)("Name of the body's material.");
    add_formula(prm, "Shape", shape)(
      "The inside of the body: a formula of x, y (, z) in m that is true "
      "inside. Shapes are box(x0, y0, [z0,] x1, y1, [z1]), ball(x, y, [z,] "
      "radius), cylinder(x0, y0, z0, x1, y1, z1, radius), half_space(n_x, n_y, "
      "[n_z,] c) with n . x <= c, and level_set(f) with a formula f that is "
      "negative inside; union(...), intersection(...) and difference(a, b, "
      "...) combine them.");
    add_parameter(prm, "Shape file", shape_file)(
      "File with a closed surface, beside the parameter file, instead of a "
      "shape. 3D: a mesh of triangles with outward normals (STL, PLY, OBJ). "
      "2D: a CSV file with the vertices of a polygon in the columns x and y; a "
      "column loop numbers several polygons, and a polygon inside of another "
      "one is a hole.");
    add_parameter(prm, "Unit of shape file", shape_file_unit, Double(1e-12))(
      "Length unit of the shape file, such as 0.001 for mm. Unit: m.");
    add_parameter(prm, "Clip at the grid", clip)(
      "Cut off the part of the body outside of the grid. If false, such a part "
      "is an error.");
    add_parameter(prm, "Points file", points_file)(
      "Points from a CSV file beside the parameter file, instead of a shape. "
      "The file has a header; lines with # are comments. Columns: x, y (, z) "
      "in m; volume in m^3 (2D: m^2) or mass in kg; optionally velocity_x, "
      "..., stress_xx, stress_yy, stress_zz, stress_xy (, stress_xz, "
      "stress_yz), J or F_xx, F_xy, ..., displacement_x or reference_x, ..., "
      "density, and the history of the material. 'Velocity', 'Stress' and 'K0' "
      "replace the columns of the file. scripts/points_to_csv converts files "
      "of VTK.");
    add_parameter(prm,
                  "Points per direction",
                  points_per_direction,
                  List(Integer(1, 12), 1, 3))(
      "Points per cell in each direction, or one number for all directions. "
      "Unit: none.");
    add_choice(prm, "Placement", placement, placements)(
      "Positions of points in a cell. equidistant: equal distances and equal "
      "volumes; Gauss: Gauss points and weights; both keep the points that are "
      "inside of the shape. fitted: Gauss points of the part of each cell "
      "inside of the shape, which follow the boundary. fitted lattice: "
      "equidistant in cells wholly inside, fitted in cut cells; for "
      "'Grid/Order' >= 2 the stress near the boundary then has an error of 0.2 "
      "to 9 %.");
    add_parameter(prm, "Jitter", jitter, Double(0., 1.))(
      "Move each point at random, by at most this fraction of half the "
      "distance between points. Unit: none.");
    add_formula(prm, "Displacement", displacement)(
      "Initial displacement from the positions in the shape: formulas of x, y "
      "(, z), separated by semicolons. The initial deformation gradient and "
      "stress follow from it. Empty: none. Unit: m.");
    add_formula(prm, "Velocity", velocity)(
      "Initial velocity: formulas of the positions x, y (, z) in the shape, "
      "separated by semicolons. Empty: at rest. Unit: m / s.");
    add_formula(prm, "Stress", stress)(
      "Initial Cauchy stress: formulas of x, y (, z) for xx; yy; zz; xy (; xz; "
      "yz). Empty: none. Unit: Pa.");
    add_parameter(prm, "K0", K0)(
      "Coefficient of earth pressure at rest, if not negative: the initial "
      "stress is the overburden pressure, -rho g depth, along gravity, and K0 "
      "times this pressure across. Unit: none.");
    add_formula(prm, "Surface", surface)(
      "Ground surface for 'K0': its coordinate along the axis of gravity, a "
      "formula of x, y (, z). No point may lie beyond it by half a cell or "
      "more. Unit: m.");
  }
} // namespace greville

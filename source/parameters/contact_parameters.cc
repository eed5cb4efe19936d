// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
#include <greville/base/parameters.h>
#include <greville/parameters/section_parameters.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <numeric>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  RigidBodyParameters::declare(ParameterHandler &prm)
  {
    add_formula(prm, "Shape", shape)(
      "The inside of the body at the start, see Body/Shape. Its edges and "
      "corners are as sharp as the formula says. Unit: m.");
    add_parameter(prm, "Shape file", shape_file)(
      "In place of 'Shape': a closed surface of triangles (3D: STL, PLY, OBJ) "
      "or polygons (2D: a CSV file with the columns x, y).");
    add_parameter(prm, "Unit of shape file", shape_file_unit, Double(1e-12))(
      "The unit of the coordinates in the file, such as 0.001 for mm. Unit: "
      "m.");
    add_parameter(prm,
                  "Reference point",
                  reference_point,
                  List(Double(), 0, 3))(
      "The point that has the velocity, about which the body turns and moments "
      "are counted, where it is at the start. Empty: the origin. Unit: m.");
    add_formula(prm, "Velocity", velocity)(
      "Velocity of the reference point: formulas of t, separated by "
      "semicolons. Empty: it stays where it is. Of a free body, the velocity "
      "at the start. Unit: m / s.");
    add_formula(prm, "Rotation", rotation)(
      "In 2D the angle about the reference point, counterclockwise, a formula "
      "of t; in 3D a rotation vector (axis times angle), three formulas of t, "
      "separated by semicolons. It is zero at the start. Empty: no rotation. "
      "Unit: rad.");
    add_parameter(prm, "Free", is_free)(
      "Whether gravity and the forces of contacts move the body. It needs a "
      "'Density', or 'Mass' and 'Inertia'.");
    add_parameter(prm, "Density", density, Double(0.))(
      "Of a free body: mass, center of mass and inertia follow from the shape. "
      "Unit: kg / m^3.");
    add_parameter(prm, "Mass", mass, Double(0.))(
      "Of a free body in place of a density; 'Reference point' is its center "
      "of "
      "mass. Unit: kg (2D: kg / m).");
    add_parameter(prm, "Inertia", inertia, List(Double(0.), 0, 3))(
      "The moment of inertia that goes with 'Mass', about the center of mass; "
      "in 3D three of them, about the axes, which are principal ones. Unit: kg "
      "m^2 (2D: kg m).");
  }



  void
  RigidBodyParameters::check(const std::string &section,
                             const unsigned int dim) const
  {
    AssertThrow(shape.empty() != shape_file.empty(),
                ExcMessage("'" + section +
                           "' needs a 'Shape' or a 'Shape file', and not "
                           "both."));
    AssertThrow(reference_point.empty() || reference_point.size() == dim,
                ExcMessage("The parameter '" + section +
                           "/Reference point' takes " + std::to_string(dim) +
                           " numbers in " + std::to_string(dim) + "D, not " +
                           std::to_string(reference_point.size()) + "."));
    const bool has_mass = mass > 0. || !inertia.empty();
    AssertThrow(is_free || (density == 0. && !has_mass),
                ExcMessage("'" + section +
                           "' has a 'Density', 'Mass' or 'Inertia', which "
                           "belong to 'Free' = true."));
    if (!is_free)
      return;
    AssertThrow((density > 0.) != has_mass,
                ExcMessage("'" + section +
                           "' is free: it needs a 'Density', or 'Mass' and "
                           "'Inertia', and not both."));
    const unsigned int n = dim == 2 ? 1 : 3;
    AssertThrow(!has_mass ||
                  (mass > 0. && inertia.size() == n &&
                   *std::min_element(inertia.begin(), inertia.end()) > 0.),
                ExcMessage("'" + section + "' needs a 'Mass' and " +
                           std::to_string(n) + " numbers of 'Inertia' in " +
                           std::to_string(dim) + "D, all above zero."));
    // A plate has the sum.
    const double sum =
      std::accumulate(inertia.begin(), inertia.end(), 0.) * (1. + 1e-9);
    AssertThrow(!has_mass || dim == 2 ||
                  2. * *std::max_element(inertia.begin(), inertia.end()) <= sum,
                ExcMessage("'" + section +
                           "' has an 'Inertia' that no body has: none of the "
                           "three numbers is larger than the sum of the "
                           "others."));
    AssertThrow(!has_mass || !reference_point.empty(),
                ExcMessage("'" + section +
                           "' has a 'Mass': it needs a 'Reference point', its "
                           "center of mass."));
    AssertThrow(has_mass || reference_point.empty(),
                ExcMessage("'" + section +
                           "' has a 'Density': its reference point is its "
                           "center of mass, and 'Reference point' is not "
                           "given."));
    AssertThrow(rotation.empty(),
                ExcMessage("'" + section +
                           "' is free: it turns by the moments of contacts, "
                           "and has no 'Rotation'."));
  }



  void
  ContactParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Bodies", bodies)(
      "The two sides, separated by a comma: names of bodies; the second "
      "one may be a rigid body. A side may be several bodies that stick to "
      "one another, joined by '+': wheel, sand + clay.");
    add_parameter(prm,
                  "Contactors",
                  contactors,
                  Selection("surface points|material points"))(
      "What of the first side meets the second one: points placed on its "
      "surface, or its outermost layer of material points, each half of its "
      "spacing ahead (initially as far as the surface, where it begins in "
      "contact). A surface that flows or tears needs the latter, which are "
      "less accurate, and updated Lagrangian steps. Unit: none.");
    add_formula(prm, "Friction", friction)(
      "The coefficient of friction mu, a number or a formula of the pressure p "
      "(Pa) and of the speed of sliding v (m / s), such as 0.2 + 0.2 * exp(-v "
      "/ 0.01); or rough: surfaces that touch do not slide. The shear stress "
      "is at most mu times the pressure, plus the adhesion. In soil with pore "
      "water p is the effective pressure: that of contact less that of the "
      "pores. Unit: none.");
    add_parameter(prm, "Adhesion", adhesion, Double(0.))(
      "Shear stress that surfaces under pressure bear without friction. Unit: "
      "Pa.");
    add_parameter(prm, "Penalty", penalty, Double(0., 1e6))(
      "kappa: the pressure is kappa E' / h times the depth of the averaged "
      "gap, "
      "with the modulus E' = E / (1 - nu^2) (the harmonic mean of both sides) "
      "and the larger cell size h of both grids. Larger values let surfaces "
      "overlap less, and shorten explicit steps. 0: 10 in implicit steps, 1 in "
      "explicit ones. Unit: none.");
    add_parameter(prm, "Method", method, Selection("penalty|augmented"))(
      "augmented adds the pressure that has been found, and solves again, up "
      "to "
      "five times in a step, until it changes by less than a thousandth (the "
      "method of Uzawa): surfaces hardly overlap then. In implicit steps only. "
      "Unit: none.");
    add_parameter(prm, "Damping", damping, Double(0., 1e3))(
      "zeta: surfaces in contact that approach one another at the speed v have "
      "the pressure zeta rho c v besides, with the impedance rho c of the "
      "softer side; likewise the shear stress of surfaces that do not slide. "
      "Without effect in implicit steps. Unit: none.");
  }



  std::array<std::vector<std::string>, 2>
  ContactParameters::sides() const
  {
    std::array<std::vector<std::string>, 2> result;
    const auto both = Utilities::split_string_list(bodies, ',');
    for (unsigned int side = 0; side < 2 && side < both.size(); ++side)
      result[side] = Utilities::split_string_list(both[side], '+');
    return result;
  }



  void
  ContactParameters::check(
    const std::string                                &section,
    const std::map<std::string, BodyParameters>      &all_bodies,
    const std::map<std::string, RigidBodyParameters> &rigid) const
  {
    std::vector<std::string> names;
    for (const auto &entry : all_bodies)
      names.push_back(entry.first);
    for (const auto &entry : rigid)
      names.push_back(entry.first);
    const auto n_sides = Utilities::split_string_list(bodies, ',').size();
    AssertThrow(n_sides == 2,
                ExcMessage("The parameter '" + section + "/Bodies' is <" +
                           bodies + ">: a contact has two sides, not " +
                           std::to_string(n_sides) + "."));
    std::vector<std::string> named;
    const auto               both = sides();
    for (const auto &side : both)
      AssertThrow(!side.empty(),
                  ExcMessage("The parameter '" + section + "/Bodies' is <" +
                             bodies + ">, of which one side is empty."));
    for (const auto &side : both)
      for (const std::string &name : side)
        {
          const std::string parameter = "The parameter '" + section +
                                        "/Bodies' has the name <" + name + ">";
          AssertThrow(std::count(names.begin(), names.end(), name) > 0,
                      ExcMessage(parameter +
                                 "; it has to be one of the bodies and rigid "
                                 "bodies of 'Simulation': " +
                                 boost::algorithm::join(names, ", ") + "." +
                                 did_you_mean(name, names)));
          AssertThrow(std::count(named.begin(), named.end(), name) == 0,
                      ExcMessage(parameter +
                                 " twice: contact of a body with itself is not "
                                 "known."));
          named.push_back(name);
          if (rigid.count(name) > 0)
            {
              AssertThrow(sides()[1] == std::vector<std::string>{name},
                          ExcMessage(parameter +
                                     ", which is a rigid body: it is the "
                                     "second side, alone, and the first side "
                                     "deforms."));
              continue;
            }
          const BodyParameters &body = all_bodies.at(name);
          const bool            needs_surface =
            !is_by_material_points() || &side == &both[1];
          AssertThrow(!needs_surface || body.points_file.empty(),
                      ExcMessage(parameter +
                                 ", which has a 'Points file': its surface is "
                                 "not known. Give it a 'Shape' or a 'Shape "
                                 "file', or let its 'Contactors' be material "
                                 "points."));
        }
    AssertThrow(!is_by_material_points() || !is_augmented(),
                ExcMessage("'" + section +
                           "/Method' = augmented does not go with "
                           "'Contactors' = material points."));
  }
} // namespace greville

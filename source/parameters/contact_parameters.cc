// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
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
      "The inside of the body at the start, see Body/Shape. Edges and corners "
      "are sharp. Unit: m.");
    add_parameter(prm, "Shape file", shape_file)(
      "File with a closed surface, in place of 'Shape': triangles (3D: STL, "
      "PLY, OBJ) or polygons (2D: CSV with the columns x, y).");
    add_parameter(prm, "Unit of shape file", shape_file_unit, Double(1e-12))(
      "Length unit of the shape file, such as 0.001 for mm. Unit: m.");
    add_parameter(prm,
                  "Reference point",
                  reference_point,
                  List(Double(), 0, 3))(
      "Initial position of the point that has the given velocity, and about "
      "which the body rotates and moments are taken. Empty: the origin. Unit: "
      "m.");
    add_formula(prm, "Velocity", velocity)(
      "Velocity of the reference point: formulas of t, separated by "
      "semicolons; for a free body the initial velocity. Empty: 0. Unit: m / "
      "s.");
    add_formula(prm, "Rotation", rotation)(
      "Rotation about the reference point. 2D: the counterclockwise angle, a "
      "formula of t. 3D: a rotation vector (axis times angle), three formulas "
      "of t, separated by semicolons. It has to be zero at the start. Empty: "
      "none. Unit: rad.");
    add_parameter(prm, "Free", is_free)(
      "Let gravity and contact forces move the body. A free body needs a "
      "'Density', or 'Mass' and 'Inertia'.");
    add_parameter(prm, "Density", density, Double(0.))(
      "Density of a free body. Mass, center of mass and inertia follow from "
      "the shape. Unit: kg / m^3.");
    add_parameter(prm, "Mass", mass, Double(0.))(
      "Mass of a free body, in place of a density. 'Reference point' is then "
      "its center of mass. Unit: kg (2D: kg / m).");
    add_parameter(prm, "Inertia", inertia, List(Double(0.), 0, 3))(
      "Moment of inertia about the center of mass, with 'Mass'. 3D: three "
      "moments, about the axes, which have to be principal axes. Unit: kg m^2 "
      "(2D: kg m).");
  }



  void
  RigidBodyParameters::check(const std::string &section,
                             const unsigned int dim) const
  {
    Require(shape.empty() != shape_file.empty(),
            "'" + section +
              "' needs a 'Shape' or a 'Shape file', and not both.");
    Require(reference_point.empty() || reference_point.size() == dim,
            "The parameter '" + section + "/Reference point' takes " +
              std::to_string(dim) + " numbers in " + std::to_string(dim) +
              "D, not " + std::to_string(reference_point.size()) + ".");
    const bool has_mass = mass > 0. || !inertia.empty();
    Require(
      is_free || (density == 0. && !has_mass),
      "'" + section +
        "' has a 'Density', 'Mass' or 'Inertia', which need 'Free' = true.");
    if (!is_free)
      return;
    Require((density > 0.) != has_mass,
            "'" + section +
              "' is free: it needs a 'Density', or 'Mass' and 'Inertia', and "
              "not both.");
    const unsigned int n = dim == 2 ? 1 : 3;
    Require(!has_mass ||
              (mass > 0. && inertia.size() == n &&
               *std::min_element(inertia.begin(), inertia.end()) > 0.),
            "'" + section + "' needs a 'Mass' and " + std::to_string(n) +
              " numbers of 'Inertia' in " + std::to_string(dim) +
              "D, all above zero.");
    // For a plate, the largest number is equal to the sum of the others.
    const double sum =
      std::accumulate(inertia.begin(), inertia.end(), 0.) * (1. + 1e-9);
    Require(!has_mass || dim == 2 ||
              2. * *std::max_element(inertia.begin(), inertia.end()) <= sum,
            "'" + section +
              "' has an impossible 'Inertia': none of the three numbers can be "
              "larger than the sum of the others.");
    Require(
      !has_mass || !reference_point.empty(),
      "'" + section +
        "' has a 'Mass': it needs a 'Reference point', its center of mass.");
    Require(has_mass || reference_point.empty(),
            "'" + section +
              "' has a 'Density': its reference point is its center of mass; "
              "leave out 'Reference point'.");
    Require(rotation.empty(),
            "'" + section +
              "' is free: moments of contacts turn it; leave out 'Rotation'.");
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
      "Points of the first side that meet the second side: surface points, or "
      "material points of the outermost layer, each moved outwards by half of "
      "its spacing (up to the surface, if the contact begins closed). A "
      "surface that flows or tears needs material points, which are less "
      "accurate, and updated Lagrangian steps. Unit: none.");
    add_formula(prm, "Friction", friction)(
      "Coefficient of friction mu: a number, or a formula of the pressure p "
      "(Pa) and of the sliding speed v (m / s), such as 0.2 + 0.2 * exp(-v / "
      "0.01); or rough: closed surfaces do not slide. The shear stress is at "
      "most mu times the pressure, plus the adhesion. In soil with pore water, "
      "p is the effective pressure: contact pressure less pore pressure. Unit: "
      "none.");
    add_parameter(prm, "Adhesion", adhesion, Double(0.))(
      "Shear strength of surfaces under pressure, in addition to friction. "
      "Unit: Pa.");
    add_parameter(prm, "Penalty", penalty, Double(0., 1e6))(
      "kappa: the pressure is kappa E' / h times the depth of the averaged "
      "gap, with the modulus E' = E / (1 - nu^2) (the harmonic mean of both "
      "sides) and the larger cell size h of both grids (in cells of different "
      "sizes, of the smallest ones with points of the contact). With larger "
      "values surfaces overlap less, and explicit steps are shorter. 0: 10 in "
      "implicit steps, 1 in explicit steps. Unit: none.");
    add_parameter(prm, "Method", method, Selection("penalty|augmented"))(
      "penalty, or augmented: Uzawa's method, which adds the last contact "
      "pressure and solves again, up to five times in a step, until the "
      "pressure changes by less than a thousandth. Surfaces then hardly "
      "overlap. augmented is for implicit steps only. Unit: none.");
    add_parameter(prm, "Damping", damping, Double(0., 1e3))(
      "zeta: surfaces in contact that approach one another at the speed v have "
      "the additional pressure zeta rho c v, with the impedance rho c of the "
      "softer side. Surfaces that stick have such a shear stress, too. "
      "Implicit steps have no damping. Unit: none.");
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
    std::vector<std::string> names = keys_of(all_bodies);
    for (const std::string &name : keys_of(rigid))
      names.push_back(name);
    const auto n_sides = Utilities::split_string_list(bodies, ',').size();
    Require(n_sides == 2,
            "The parameter '" + section + "/Bodies' is <" + bodies +
              ">: a contact has two sides, not " + std::to_string(n_sides) +
              ".");
    std::vector<std::string> named;
    const auto               both = sides();
    for (const auto &side : both)
      Require(!side.empty(),
              "The parameter '" + section + "/Bodies' is <" + bodies +
                ">: one side is empty.");
    for (const auto &side : both)
      for (const std::string &name : side)
        {
          const std::string parameter = "The parameter '" + section +
                                        "/Bodies' has the name <" + name + ">";
          Require(contains(names, name),
                  parameter +
                    "; it has to be one of the bodies and rigid bodies of "
                    "'Simulation': " +
                    boost::algorithm::join(names, ", ") + "." +
                    did_you_mean(name, names));
          Require(!contains(named, name),
                  parameter +
                    " twice: contact of a body with itself is not supported.");
          named.push_back(name);
          if (rigid.count(name) > 0)
            {
              Require(sides()[1] == std::vector<std::string>{name},
                      parameter +
                        ", which is a rigid body: it has to be the second "
                        "side, alone, and the first side has to deform.");
              continue;
            }
          const BodyParameters &body = all_bodies.at(name);
          const bool            needs_surface =
            !is_by_material_points() || &side == &both[1];
          Require(!needs_surface || body.points_file.empty(),
                  parameter + ", which has a 'Points file': its surface is "
                              "unknown. Give it a 'Shape' or a 'Shape file', "
                              "or take 'Contactors' = material points.");
        }
    Require(!is_by_material_points() || !is_augmented(),
            "'" + section +
              "/Method' = augmented does not support 'Contactors' = material "
              "points.");
  }
} // namespace greville

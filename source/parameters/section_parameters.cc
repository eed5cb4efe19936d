// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/parameters/names.h>
#include <greville/parameters/simulation_parameters.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  GeneralParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Name", name)(
      "Results go to output/NAME. Empty: the name of the file.");
    add_parameter(prm, "Dimension", dimension, Integer(2, 3))(
      "2 (plane strain) or 3. Unit: none.");
    add_parameter(prm, "Bodies", bodies)(
      "Names of bodies; each has a section 'Body NAME'.");
    add_parameter(prm, "Materials", materials)(
      "Names of materials; each has a section 'Material NAME'.");
    add_parameter(prm, "Surface loads", surface_loads)(
      "Names of loads on the surfaces of bodies with fitted points; each has a "
      "section 'Surface load NAME'.");
    add_parameter(prm, "Rigid bodies", rigid_bodies)(
      "Names of bodies that do not deform, for contacts; each has a section "
      "'Rigid body NAME'.");
    add_parameter(prm, "Contacts", contacts)(
      "Names of contacts; each has a section 'Contact NAME'. Bodies that no "
      "contact names share a velocity field, and stick where they meet.");
    add_parameter(prm, "Stages", stages)(
      "Names of stages, one after the other; each has a section 'Stage NAME', "
      "which contains those of the sections Time, Scheme, Walls, Loads, "
      "Implicit and Newton in which it differs from the sections outside, with "
      "what differs. Empty: one stage.");
  }



  void
  GridParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Lower corner", lower, List(Double(), 2, 3))(
      "Corner of the grid with the smallest coordinates. Unit: m.");
    add_parameter(prm, "Upper corner", upper, List(Double(), 2, 3))(
      "Corner with the largest coordinates. Unit: m.");
    add_parameter(prm, "Cells", cells, List(Integer(1), 2, 3))(
      "Cells in each direction. Unit: none.");
    add_parameter(prm, "Order", degree, Integer(1, SplineSpace<2>::max_degree))(
      "Order p of the B-splines: the degree of their polynomials. In "
      "isogeometric analysis the order is the degree plus one; here it is the "
      "degree. Unit: none.");
    add_parameter(prm, "Per body", per_body)(
      "With total Lagrangian steps: each body has fields of its own on the "
      "part of the grid around it, so that bodies may be close to one another. "
      "It is so, too, where a body has a section 'Grid'.");
  }



  void
  BodyGridParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Lower corner", lower, List(Double(), 0, 3))(
      "The grid of this body in total Lagrangian steps, of which the part "
      "around the body is taken; then each body has a grid of its own. "
      "Empty: as in the section 'Grid' outside. Walls act on sides that lie "
      "on those of that grid. Unit: m.");
    add_parameter(prm, "Upper corner", upper, List(Double(), 0, 3))(
      "Likewise. Unit: m.");
    add_parameter(prm, "Cells", cells, List(Integer(1), 0, 3))(
      "Cells between the corners in each direction; they are needed where a "
      "corner is given. Empty: as in the section 'Grid' outside. Unit: none.");
    add_parameter(prm, "Order", degree, Integer(0, SplineSpace<2>::max_degree))(
      "Order p of the B-splines. 0: as in the section 'Grid' outside. Unit: "
      "none.");
  }



  void
  ConsistentSolverParameters::declare(ParameterHandler &prm)
  {
    SolverParameters::declare(prm);
    add_parameter(prm, "Method", method, Selection(mass_solver_methods()))(
      "The solver of the consistent mass: conjugate gradients for all "
      "components together, preconditioned by IC(0) (cg-ic0, the fastest for "
      "mass matrices), by the cycle of 'p-multigrid' (cg-p-multigrid), by the "
      "diagonal (cg-jacobi), or not at all (cg).");
  }



  void
  SurfaceLoadParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Body", body)(
      "The name of the body that bears the load. Its 'Placement' is fitted or "
      "fitted lattice.");
    add_parameter(prm, "Where", where)(
      "The part of the surface that bears the load: what is inside this shape "
      "initially (see Body/Shape; X is called x). It is best to let it end at "
      "corners and edges of the body, or between two points. Empty: all of it. "
      "Unit: m.");
    add_parameter(prm,
                  "Kind",
                  kind,
                  Selection("traction|pressure|dashpot|spring|displacement"))(
      "traction: a force of constant direction per area; pressure: acts "
      "against "
      "the normal, which turns with the surface; dashpot: lets waves leave, "
      "-rho (c_p v_n n + c_s v_t) with the wave speeds of the body's material; "
      "spring: -k (x - X); displacement: u(X, t) is given, and held by springs "
      "-k (x - X - u), which give way by their stress over k.");
    add_parameter(prm, "Traction", traction)(
      "traction: formulas of x, y (, z), the initial positions X, Y (, Z) and "
      "t, separated by semicolons. Unit: Pa.");
    add_parameter(prm, "Area", area, Selection("initial|current"))(
      "traction: the area that it is a force per.");
    add_parameter(prm, "Pressure", pressure)(
      "pressure: a formula of the same variables; positive values press. Unit: "
      "Pa.");
    add_parameter(prm, "Stiffness", stiffness, Double(0.))(
      "spring, displacement: k, per initial area. 0, with displacement only: "
      "10 "
      "times the modulus of pressure waves of the material over the smallest "
      "edge of a cell, h: the error of the displacement is h / 10 times the "
      "strain at the surface. Unit: Pa / m.");
    add_parameter(prm, "Displacement", displacement)(
      "displacement: formulas of X, Y (, Z) and t, separated by semicolons. "
      "Unit: m.");
  }



  void
  SurfaceLoadParameters::check(
    const std::string                           &section,
    const std::map<std::string, BodyParameters> &bodies) const
  {
    std::vector<std::string> names;
    for (const auto &entry : bodies)
      names.push_back(entry.first);
    AssertThrow(bodies.count(body) == 1,
                ExcMessage("The parameter '" + section + "/Body' is <" + body +
                           ">; it has to be one of the bodies of "
                           "'Simulation/Bodies': " +
                           boost::algorithm::join(names, ", ") + "." +
                           did_you_mean(body, names)));
    const BodyParameters &bearer = bodies.at(body);
    AssertThrow(bearer.points_file.empty() &&
                  bearer.placement.compare(0, 6, "fitted") == 0,
                ExcMessage(
                  "'" + section + "' acts on the surface of 'Body " + body +
                  "', which is known of a 'Shape' with 'Placement' = fitted or "
                  "fitted lattice only; here " +
                  (bearer.points_file.empty()
                     ? "'Placement' is " + bearer.placement
                     : "there is a 'Points file'") +
                  "."));
    AssertThrow(bearer.imposed_velocity.empty(),
                ExcMessage("'" + section + "' acts on 'Body " + body +
                           "', which has an 'Imposed velocity' and feels no "
                           "force."));
    // What each kind needs, and all others do without.
    const auto belongs = [&](const bool                      is_given,
                             const std::string              &name,
                             const std::vector<std::string> &kinds,
                             const bool                      is_needed) {
      const bool is_its =
        std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
      AssertThrow(is_its || !is_given,
                  ExcMessage("The parameter '" + section + "/" + name +
                             "' belongs to 'Kind' = " +
                             boost::algorithm::join(kinds, " and ") + ", not " +
                             kind + "."));
      AssertThrow(!is_its || is_given || !is_needed,
                  ExcMessage("'" + section + "' has 'Kind' = " + kind +
                             " and needs the parameter '" + name + "'."));
    };
    belongs(!traction.empty(), "Traction", {"traction"}, true);
    belongs(area != "initial", "Area", {"traction"}, false);
    belongs(!pressure.empty(), "Pressure", {"pressure"}, true);
    belongs(!displacement.empty(), "Displacement", {"displacement"}, true);
    belongs(stiffness > 0.,
            "Stiffness",
            {"spring", "displacement"},
            kind == "spring");
  }



  void
  RigidBodyParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Shape", shape)(
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
    add_parameter(prm, "Velocity", velocity)(
      "Velocity of the reference point: formulas of t, separated by "
      "semicolons. Empty: it stays where it is. Unit: m / s.");
    add_parameter(prm, "Rotation", rotation)(
      "In 2D the angle about the reference point, counterclockwise, a formula "
      "of t; in 3D a rotation vector (axis times angle), three formulas of t, "
      "separated by semicolons. It is zero at the start. Empty: no rotation. "
      "Unit: rad.");
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
  }



  void
  ContactParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Bodies", bodies)(
      "The two sides, separated by a comma: names of bodies, or of a rigid "
      "body "
      "as the second one. "
      "A side may be several bodies that stick to one another, joined by '+': "
      "wheel, sand + clay.");
    add_parameter(prm, "Friction", friction)(
      "The coefficient of friction mu, or rough: surfaces that touch do not "
      "slide. The shear stress is at most mu times the pressure, plus the "
      "adhesion. Unit: none.");
    add_parameter(prm, "Adhesion", adhesion, Double(0.))(
      "Shear stress that surfaces under pressure bear without friction. Unit: "
      "Pa.");
    add_parameter(prm, "Penalty", penalty, Double(1e-6))(
      "kappa: the pressure is kappa E' / h times the depth of the averaged "
      "gap, "
      "with the modulus E' = E / (1 - nu^2) (the harmonic mean of both sides) "
      "and the larger cell size h of both grids. Larger values let surfaces "
      "overlap less, and shorten explicit steps. 0: 10 in implicit steps, 1 in "
      "explicit ones. Unit: none.");
    add_parameter(prm, "Damping", damping, Double(0.))(
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



  double
  ContactParameters::friction_coefficient(const std::string &section) const
  {
    if (friction == "rough")
      return std::numeric_limits<double>::infinity();
    double mu = -1.;
    try
      {
        mu = Utilities::string_to_double(friction);
      }
    catch (const std::exception &)
      {}
    AssertThrow(mu >= 0. && std::isfinite(mu),
                ExcMessage("The parameter '" + section + "/Friction' is <" +
                           friction +
                           ">, and has to be rough or a number that is not "
                           "negative."));
    return mu;
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
    for (const auto &side : sides())
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
          AssertThrow(body.imposed_velocity.empty(),
                      ExcMessage(parameter +
                                 ", which has an 'Imposed velocity': make it "
                                 "one of 'Simulation/Rigid bodies'."));
          AssertThrow(body.points_file.empty(),
                      ExcMessage(parameter +
                                 ", which has a 'Points file': its surface is "
                                 "not known. Give it a 'Shape' or a 'Shape "
                                 "file'."));
        }
    friction_coefficient(section);
  }
} // namespace greville

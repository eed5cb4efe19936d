// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
#include <greville/parameters/names.h>
#include <greville/parameters/simulation_parameters.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>

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
    add_parameter(prm, "Additional shared libraries", shared_libraries)(
      "Plugins: shared libraries that add material laws, loads, integrators "
      "and other parts, relative to the folder of this file.");
    add_parameter(prm, "Pore water", pore_water)(
      "Whether water fills the pores of all bodies, with a pressure of its "
      "own: stresses are effective ones then. A body of the 'Porosity' 0 that "
      "a contact names is dry.");
  }



  void
  WaterParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Density", density, Double(1e-3))(
      "With 'Simulation/Pore water': density of the water. Unit: kg / m^3.");
    add_parameter(prm, "Bulk modulus", bulk_modulus, Double(0.))(
      "With 'Simulation/Pore water': bulk modulus of the water; 0: it is "
      "incompressible. Unit: Pa.");
    add_formula(prm, "Table", table)(
      "The water table at the start, as the coordinate along gravity's axis: a "
      "formula of x, y (, z). Bodies begin with the pressure of water at rest, "
      "and 'K0' with the weight of the soil less that. Empty: the pressure is "
      "0. Unit: m.");
    add_parameter(prm, "Capillary height", capillary_height, Double(0.))(
      "The suction, as a height of water, at which pores are so empty that "
      "the conductivity is a thousandth; it falls from 0 on. 0: pores stay "
      "full at any suction. Unit: m.");
    add_formula(prm, "Free surface pressure", free_surface_pressure)(
      "The pressure of water around all bodies, a formula of x, y (, z) and t: "
      "that of the pores in the outermost layer of points, wherever it is, and "
      "a load on the surface, 0 in air. Empty: no water passes the surface but "
      "at surface loads and walls. Unit: Pa.");
    add_choice<bool>(prm,
                     "Integration",
                     is_second_order,
                     {{false, "backward-euler"}, {true, "BDF2"}})(
      "The flow of the water in time: backward Euler, of order 1 in the step, "
      "or BDF2, of order 2. The first step of a stage, and one that is more "
      "than 2.4 times as long as the last one, are backward Euler all the "
      "same. "
      "BDF2 belongs to implicit and quasi-static steps. Unit: none.");
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
    add_parameter(prm,
                  "Geometry",
                  geometry,
                  Selection("plane strain|axisymmetric"))(
      "Of 2D files. Axisymmetric: x is the distance r from the axis, along "
      "which y runs; volumes, masses, forces and energies are those per "
      "radian. "
      "A grid that begins at x = 0 begins at the axis, at which 'Walls/Left' "
      "holds the radial component whatever else it does.");
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
    add_formula(prm, "Where", where)(
      "The part of the surface that bears the load: what is inside this shape "
      "initially (see Body/Shape; X is called x). It is best to let it end at "
      "corners and edges of the body, or between two points. Empty: all of it. "
      "Unit: m.");
    add_parameter(prm, "Kind", kind_name, Selection(surface_load_kinds()))(
      "traction: a force of constant direction per area; pressure: a force "
      "against the normal, which turns with the surface; dashpot: absorbs "
      "waves, -rho (c_p v_n n + c_s v_t) with the wave speeds of the body's "
      "material; spring: -k (x - X); displacement: u(X, t) is imposed by "
      "springs -k (x - X - u), which yield by their stress over k. The "
      "parameters of the kind are set in the same section.");
    add_formula(prm, "Pore pressure", pore_pressure)(
      "With 'Simulation/Pore water': the pressure of the water at this part of "
      "the surface, a formula of x, y (, z), X, Y (, Z) and t. Tractions and "
      "pressures of loads are total ones, of soil and water. Empty: no water "
      "passes. Unit: Pa.");
    add_parameter(prm, "Seepage face", seepage_face)(
      "Whether water only leaves where 'Pore pressure' is 0 or less, as in "
      "air: the pressure is at most the given one there. Where it is above 0, "
      "as below a water level, water passes both ways.");
    add_formula(prm, "Flux", flux)(
      "In place of 'Pore pressure': the water that leaves per area and time "
      "(negative: that comes, as rain), a formula of the same variables. Unit: "
      "m / s.");
    if (kind)
      kind->declare(prm);
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
                  (bearer.placement == Placement::fitted ||
                   bearer.placement == Placement::fitted_lattice),
                ExcMessage(
                  "'" + section + "' acts on the surface of 'Body " + body +
                  "', which is known of a 'Shape' with 'Placement' = fitted or "
                  "fitted lattice only; here " +
                  (bearer.points_file.empty()
                     ? "'Placement' is " + word_of(bearer.placement, placements)
                     : "there is a 'Points file'") +
                  "."));
    kind->check(section);
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/names.h>
#include <greville/parameters/simulation_parameters.h>

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
    for (const auto &[list, names] :
         {std::pair<std::string, std::vector<std::string> *>{"Bodies", &bodies},
          {"Materials", &materials},
          {"Rigid bodies", &rigid_bodies},
          {"Surface loads", &surface_loads},
          {"Contacts", &contacts}})
      add_parameter(prm, list, *names)(
        "Names, each of which has a section such as 'Body NAME'. Rigid bodies "
        "do not deform, and act by contacts; bodies without a contact share a "
        "velocity field, and stick when they meet. Surface loads act on bodies "
        "with fitted points.");
    add_parameter(prm, "Stages", stages)(
      "Names of consecutive stages; each has a section 'Stage NAME' with the "
      "parameters of the sections Time, Scheme, Walls, Loads, Implicit and "
      "Newton that differ from the outer sections. Empty: one stage.");
    add_parameter(prm, "Additional shared libraries", shared_libraries)(
      "Plugins: shared libraries that add material laws, loads, integrators "
      "and other parts, relative to the folder of the parameter file.");
    add_parameter(prm, "Pore water", pore_water)(
      "Fill the pores of all bodies with water, which has a pressure of its "
      "own. Stresses are then effective stresses. A body in a contact is dry "
      "if its 'Porosity' is 0.");
  }



  void
  WaterParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Density", density, Double(1e-3))(
      "Density of the pore water. Unit: kg / m^3.");
    add_parameter(prm, "Bulk modulus", bulk_modulus, Double(0.))(
      "Bulk modulus of the pore water; 0: incompressible. Unit: Pa.");
    add_formula(prm, "Table", table)(
      "Initial water table, as the coordinate along the axis of gravity: a "
      "formula of x, y (, z). Bodies begin with hydrostatic pore pressure, and "
      "'K0' with the overburden pressure less the pore pressure. Empty: the "
      "pore pressure is 0. Unit: m.");
    add_parameter(prm, "Capillary height", capillary_height, Double(0.))(
      "Suction, as a height of water, at which the conductivity has fallen to "
      "a thousandth. 0: pores stay full at any suction. Unit: m.");
    add_formula(prm, "Free surface pressure", free_surface_pressure)(
      "Pressure of the water around all bodies, 0 in air: a formula of x, y (, "
      "z) and t. It is the pore pressure in the outermost layer of points, "
      "wherever this layer is, and a load on the surface. Empty: the surface "
      "is impervious outside of surface loads and walls. Unit: Pa.");
    add_choice<bool>(prm,
                     "Integration",
                     is_second_order,
                     {{false, "backward-euler"}, {true, "BDF2"}})(
      "Time integration of the pore water: backward-euler, of order 1, or "
      "BDF2, of order 2 (implicit and quasi-static steps only). The first step "
      "of a stage, and a step more than 2.4 times as long as the last one, use "
      "backward Euler in any case. Unit: none.");
  }



  void
  GridParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Lower corner", lower, List(Double(), 2, 3))(
      "Corner of the grid with the smallest coordinates. Unit: m.");
    add_parameter(prm, "Upper corner", upper, List(Double(), 2, 3))(
      "Corner with the largest coordinates. Unit: m.");
    add_parameter(prm, "Cells", cells, List(Integer(0), 2, 3))(
      "Cells in each direction. 0 in directions with 'Knots': as many as these "
      "make; a multiple of that number divides each cell. Unit: none.");
    for (unsigned int d = 0; d < 3; ++d)
      add_parameter(prm, "Knots " + std::string(1, "xyz"[d]), knots[d])(
        "Cells of different sizes in this direction: the edges of all cells, "
        "or "
        "fine(BEGIN, END, SIZE) ratio R, for cells of this size in a range, "
        "from "
        "which each next cell is at most R times as large; several ranges, and "
        "the largest size, as in fine(0, 1, 0.1) fine(3, 4, 0.2) ratio 1.3 "
        "largest 0.5. Empty: equal cells. Unit: m.");
    add_parameter(prm, "Refinement", refinement)(
      "Names of regions with smaller cells; each has a section 'Refinement "
      "NAME'. The splines are truncated hierarchical B-splines.");
    for (const auto &[name, number] :
         {std::pair<std::string, unsigned int *>{"Adapt every", &adapt_every},
          {"Adapt at start", &adapt_at_start},
          {"Most cells", &most_cells}})
      add_parameter(prm, name, *number, Integer(0))(
        "Cells that change. Adapt every: steps between two adaptations to the "
        "regions of 'Refinement'; points are divided so that two are left in "
        "each direction of a cell. Adapt at start: how often the first step is "
        "tried before the run begins; each time the cells are adapted to its "
        "results, and the bodies are placed anew. Most cells: indicators halve "
        "cells only as long as the grid has fewer. 0: none. Unit: none.");
    add_parameter(prm, "Order", degree, Integer(1, SplineSpace<2>::max_degree))(
      "Order p of the B-splines: the degree of their polynomials. In "
      "isogeometric analysis the order is the degree plus one; here it is the "
      "degree. Unit: none.");
    add_parameter(prm,
                  "Geometry",
                  geometry,
                  Selection("plane strain|axisymmetric"))(
      "Geometry of 2D simulations. axisymmetric: x is the distance from the "
      "axis, and y runs along the axis; volumes, masses, forces and energies "
      "are per radian. If the grid begins at x = 0, its left side is the axis, "
      "at which radial velocities are zero.");
    add_parameter(prm, "Per body", per_body)(
      "Give each body fields of its own on the part of the grid around it, so "
      "that bodies may be close to one another, in total Lagrangian steps. "
      "This is always so if a body has a section 'Grid'.");
  }



  void
  RefinementParameters::declare(ParameterHandler &prm)
  {
    add_formula(prm, "Shape", shape)(
      "Region of small cells, a formula as 'Body NAME/Shape': cells are halved "
      "until the centres of the smallest ones in the region are those of cells "
      "of the last level. Cells around it are halved, too, so that sizes "
      "change gradually. With 'Grid/Adapt every' it may contain the time t. "
      "With an 'Indicator', only cells in the region are halved; empty: all. "
      "Unit: m.");
    add_parameter(prm, "Levels", levels, Integer(1, 6))(
      "How often the cells of 'Grid/Cells' are halved. Unit: none.");
    add_choice(prm, "Indicator", indicator, indicators)(
      "Which cells of the region are halved when the grid is adapted. none: "
      "all. plastic strain: cells with a point above 'Refine above'. stress "
      "jump: the cells with the largest differences between the stresses of "
      "their points and a spline through all stresses, which together have 0.6 "
      "of the sum of squares. Cells join again below a tenth of the smallest "
      "value that halves cells.");
    add_parameter(prm, "Refine above", refine_above, Double(0.))(
      "Plastic strain of points whose cells are halved. Unit: none.");
    add_parameter(prm, "Distance to surface", distance, Double(0.))(
      "Largest distance of the cells that are halved from the surface of a "
      "body "
      "or rigid body, as it is when the grid is adapted; 0: any distance. "
      "Sides "
      "of the grid are not surfaces. Cells also have to be in 'Shape', unless "
      "this is empty. Unit: m.");
    for (const auto &[name, time] :
         {std::pair<std::string, std::vector<double> *>{"From", &from},
          {"Until", &until}})
      add_parameter(prm, name, *time, List(Double(), 0, 1))(
        "Times between which the cells of the region are halved, with "
        "'Grid/Adapt every'. Empty: always. Unit: s.");
  }



  void
  BodyGridParameters::declare(ParameterHandler &prm)
  {
    const std::string corners =
      "Smallest (lower) and largest (upper) corner of the grid of this body in "
      "total Lagrangian steps. The body uses the part of this grid around it, "
      "and each other body has a grid of its own, too. Walls act on sides of "
      "this grid that lie on sides of the outer 'Grid'. Empty: as in the outer "
      "section 'Grid'. Unit: m.";
    add_parameter(prm, "Lower corner", lower, List(Double(), 0, 3))(corners);
    add_parameter(prm, "Upper corner", upper, List(Double(), 0, 3))(corners);
    add_parameter(prm, "Cells", cells, List(Integer(1), 0, 3))(
      "Cells between the corners in each direction; needed if a corner is "
      "given. Empty: as in the outer section 'Grid'. Unit: none.");
    add_parameter(prm, "Order", degree, Integer(0, SplineSpace<2>::max_degree))(
      "Order p of the B-splines. 0: as in the outer section 'Grid'. Unit: "
      "none.");
  }



  void
  ConsistentSolverParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Tolerance", tolerance, Double(0., 1.))(
      "Largest Euclidean norm of the residual over the norm of the right-hand "
      "side at which iterations end. 0: in plane and 3D explicit steps without "
      "pore water 1e-5 for order 1 or 2, 1e-6 for order 3 and 1e-7 for order "
      "4, otherwise 1e-8. Unit: none.");
    add_parameter(prm,
                  "Method",
                  method,
                  Selection("cg-ic0|cg-p-multigrid|cg-jacobi|cg"))(
      "Solver of the consistent mass: conjugate gradients for all components "
      "together, preconditioned by incomplete Cholesky factors (cg-ic0, the "
      "fastest), by the cycle of 'p-multigrid' (cg-p-multigrid), by the "
      "diagonal (cg-jacobi), or not at all (cg).");
  }



  void
  SurfaceLoadParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Body", body)("Name of the loaded body. Its 'Placement' "
                                     "has to be fitted or fitted lattice.");
    add_formula(prm, "Where", where)(
      "Loaded part of the surface: the part that is initially inside of this "
      "shape (see Body/Shape). Let it end at corners and edges of the body, or "
      "between two points. Empty: the whole surface. Unit: m.");
    add_parameter(prm, "Kind", kind_name, Selection(surface_load_kinds()))(
      "traction: a force of constant direction per area; pressure: a force "
      "against the normal, which turns with the surface; dashpot: absorbs "
      "waves, -rho (c_p v_n n + c_s v_t) with the wave speeds of the body's "
      "material; spring: -k (x - X); displacement: u(X, t) is imposed by "
      "springs -k (x - X - u), which yield by their stress over k. The "
      "parameters of the kind are set in the same section.");
    add_formula(prm, "Pore pressure", pore_pressure)(
      "Pore pressure at the loaded surface, with 'Simulation/Pore water': a "
      "formula of x, y (, z), X, Y (, Z) and t. Tractions and pressures of "
      "loads are total stresses, of soil and water. Empty: impervious. Unit: "
      "Pa.");
    add_parameter(prm, "Seepage face", seepage_face)(
      "Seepage face: if the given 'Pore pressure' is 0 or less, as in air, "
      "water can only leave, and the pore pressure is at most the given one. "
      "If it is above 0, as below a water level, water can enter, too.");
    add_formula(prm, "Flux", flux)(
      "Outflow of water per area and time (negative: inflow, such as rain), in "
      "place of 'Pore pressure': a formula of the same variables. Unit: m / "
      "s.");
    if (kind)
      kind->declare(prm);
  }



  void
  SurfaceLoadParameters::check(
    const std::string                           &section,
    const std::map<std::string, BodyParameters> &bodies) const
  {
    const auto names = keys_of(bodies);
    check_known(body,
                section + "/Body",
                names,
                "the bodies of 'Simulation/Bodies': " +
                  boost::algorithm::join(names, ", "));
    const BodyParameters &bearer = bodies.at(body);
    Require(bearer.points_file.empty() &&
              (bearer.placement == Placement::fitted ||
               bearer.placement == Placement::fitted_lattice),
            "'" + section + "' acts on the surface of 'Body " + body +
              "', which needs a 'Shape' with 'Placement' = fitted or fitted "
              "lattice; here " +
              (bearer.points_file.empty()
                 ? "'Placement' is " + word_of(bearer.placement, placements)
                 : "there is a 'Points file'") +
              ".");
    kind->check(section);
  }
} // namespace greville

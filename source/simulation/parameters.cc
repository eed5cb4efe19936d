// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/simulation/consistent_mass.h>
#include <greville/simulation/grid_mass.h>
#include <greville/simulation/parameters.h>
#include <greville/simulation/point_fields.h>
#include <greville/simulation/time_integrator.h>

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
    add_parameter(prm, "Tractions", tractions)(
      "Names of tractions; each has a section 'Traction NAME'.");
    add_parameter(prm, "Surface loads", surface_loads)(
      "Names of loads on the surfaces of bodies with fitted points; each has a "
      "section 'Surface load NAME'.");
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
    declare_other_names(prm, "Order");
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
    declare_other_names(prm, "Order");
  }



  void
  TimeParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Start", start)(
      "The initial time, of the first stage: a later one begins where the last "
      "one ends, and has no 'Start'. Unit: s.");
    add_parameter(prm, "End", end)(
      "Stages end one after the other: time runs on over them. Unit: s.");
    add_parameter(prm, "Step", step)(
      "A formula of the smallest edge h of a cell (m) and the order p. Empty: "
      "from the CFL number and the critical step. Unit: s.");
    add_parameter(prm, "CFL number", cfl, Double(0.))(
      "An automatic step is at most this part of h / (c + |v|), with the speed "
      "c of pressure waves and v of points. Unit: none.");
    add_parameter(prm, "Safety", safety, Double(0., 1.))(
      "An automatic step is at most this fraction of the critical step. Unit: "
      "none.");
    add_parameter(prm,
                  "Too large step",
                  too_large_step,
                  Selection("refuse|warn|ignore"))(
      "What to do about a given step above the critical one.");
    add_parameter(prm, "Estimate every", estimate_every, Integer(0))(
      "The critical step is estimated again after this number of steps, and "
      "after up to eight times as many while it changes by less than 2 %; 0: "
      "in the first step only. It is estimated again, too, where the largest "
      "wave speed has grown by 10 %, and, for automatic steps with consistent "
      "mass (not with USF), where accelerations show them to be too long. "
      "Unit: steps.");
    add_parameter(prm,
                  "Velocities at",
                  velocities,
                  Selection("half steps|full steps"))(
      "Velocities belong to the middle of a step (central differences, second "
      "order) or to its end (symplectic Euler, first order).");
    add_parameter(prm, "Maximum steps", max_steps, Integer(0))(
      "A run ends after this number of steps; 0: no limit. Unit: steps.");
    add_parameter(prm, "Largest displacement", most_displacement, Double(0.))(
      "A run ends after the step in which a point of a body that is not moved "
      "as a rigid one is further than this from its initial position (with "
      "'Stage/Reset displacements': from where it was at the start of the "
      "stage); 0: no limit. Unit: m.");
  }



  void
  SchemeParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm,
                  "Formulation",
                  formulation,
                  Selection("updated Lagrangian|total Lagrangian"))(
      "Where basis functions are taken: at the current positions of points, "
      "which move through the grid (updated Lagrangian, for flow and any "
      "deformation), or at their initial ones (total Lagrangian, for solids: "
      "the grid is that of the initial configuration, walls act on it, and the "
      "mass matrix never changes). With total Lagrangian, bodies do not see "
      "one "
      "another.");
    add_parameter(prm, "Mass", mass)(
      "The mass M of M a = F: auto (lumped for fluids, Drucker-Prager and "
      "Mohr-Coulomb materials and with APIC, consistent otherwise and in total "
      "Lagrangian steps), consistent "
      "(the exact mass matrix on extended B-splines), lumped, or "
      "approximations of the exact one by K terms of a series: " +
      mass_names() + ".");
    add_parameter(prm, "Filling threshold", filling, Double(-1., 2.))(
      "Consistent mass of explicit steps: cells that points fill by this "
      "fraction of their volume or more are well-filled; B-splines that see no "
      "well-filled cell inside the body are extended from such cells. 0: none "
      "is extended. Negative: 0.45 in updated and 0.1 in total Lagrangian "
      "steps. Unit: none.");
    add_parameter(prm, "Filter", filter, Double(0., 100.))(
      "Consistent mass: strength of the high-order filter of the velocity, "
      "which damps what points that cross cells excite: the fraction of the "
      "highest mode that is removed per cell that is crossed, five times as "
      "much for order 1. 0: none; steps then gain energy. Total Lagrangian "
      "steps cross no cells and have none. Unit: none.");
    add_parameter(prm,
                  "Stress update",
                  stress_update,
                  Selection(time_integrator_names()))(
      "When stresses are updated: last (USL), first (USF), or last with "
      "velocities of the grid made anew from the points (MUSL).");
    add_parameter(prm, "Transfer", transfer, Selection("FLIP|PIC|APIC"))(
      "How points take their velocity from the grid.");
    add_parameter(prm, "FLIP share", flip, Double(0., 1.))(
      "The fraction of FLIP that the velocities of points keep in 'FLIP time', "
      "the rest being PIC: in a step dt it is the share to the power dt / "
      "'FLIP time'. 1: all of FLIP, 0: all of PIC. Unit: none.");
    add_parameter(prm, "FLIP time", flip_time, Double(0.))(
      "The time that 'FLIP share' belongs to. 0: in which the fastest initial "
      "wave crosses a cell. Unit: s.");
    add_parameter(prm,
                  "Quadrature",
                  quadrature,
                  Selection("points|least-squares|taylor-least-squares"))(
      "Integrals over the body by its points, or by Gauss points of full cells "
      "with density, momentum and stress reconstructed by least squares, or by "
      "Taylor least squares, which conserve mass and momentum cell by cell.");
    add_parameter(prm, "Full cell", full_cell, Double(0., 2.))(
      "For reconstructions: cells are full where their points have this part "
      "of their volume and no surface of the body cuts them. Others are "
      "integrated by points. Unit: none.");
    add_parameter(prm,
                  "Volumetric projection",
                  volumetric_projection,
                  Selection("none|order p-1|coarse mesh"))(
      "Against locking of nearly incompressible bodies and of plastic flow "
      "(F-bar): materials see the ratio of volumes projected on other "
      "B-splines. order p-1: of one order less, which are means in cells for "
      "order 1. coarse mesh: of the same order on cells of twice the size, "
      "which gives smooth pressures.");
    add_parameter(prm,
                  "Energy gain",
                  energy_gain,
                  Selection("stop|warn|ignore"))(
      "What to do where the bodies have more energy than they had initially "
      "and loads and walls have given them, less what damping has taken, which "
      "an unstable step shows.");
    add_parameter(prm, "Energy tolerance", energy_tolerance, Double(0.))(
      "The gain that is accepted, as a fraction of the largest energy so far. "
      "Unit: none.");
    add_parameter(prm, "Points outside", outside, Selection("error|remove"))(
      "What to do about points that leave the grid.");
  }



  void
  ConsistentSolverParameters::declare(ParameterHandler &prm)
  {
    SolverParameters::declare(prm);
    add_parameter(prm,
                  "Method",
                  method,
                  Selection(ConsistentMass<2>::methods()))(
      "The solver of the consistent mass: conjugate gradients for all "
      "components together, preconditioned by IC(0) (cg-ic0, the fastest for "
      "mass matrices), by the cycle of 'p-multigrid' (cg-p-multigrid), by the "
      "diagonal (cg-jacobi), or not at all (cg).");
  }



  const std::array<std::string, 6> WallParameters::names = {
    {"Left", "Right", "Bottom", "Top", "Back", "Front"}};

  void
  WallParameters::declare(ParameterHandler &prm)
  {
    static const char *places[] = {"smallest x",
                                   "largest x",
                                   "smallest y",
                                   "largest y",
                                   "smallest z",
                                   "largest z"};
    for (unsigned int w = 0; w < 6; ++w)
      {
        add_parameter(prm,
                      names[w],
                      type[w],
                      Selection("free|fixed|sliding|moving|friction|periodic"))(
          "The wall of " + std::string(places[w]) +
          ": free, fixed (sticks), sliding (without friction), moving (with "
          "the "
          "velocity or displacement below), friction (sliding with the "
          "coefficient below) or periodic (what leaves the grid here comes in "
          "at the wall on the other side, which is periodic, too; in all "
          "stages).");
        add_parameter(prm, names[w] + " region", region[w])(
          "Of a fixed, sliding or moving wall: the shape or condition in which "
          "it is, beside which it is free; empty: everywhere. Coefficients "
          "whose Greville abscissae are inside are held.");
        add_parameter(prm, names[w] + " velocity", velocity[w])(
          "Of a moving wall: formulas of x, y (, z) and t separated by "
          "semicolons. A sliding wall may have one, of which the normal "
          "component counts. Unit: m / s.");
        add_parameter(prm, names[w] + " displacement", displacement[w])(
          "In place of the velocity: formulas of x, y (, z) and t separated by "
          "semicolons, d(x, t). A step moves the wall by d(x, t + dt) - d(x, "
          "t). Unit: m.");
        add_parameter(prm, names[w] + " friction", friction[w], Double(0.))(
          "Coefficient of Coulomb friction of a friction wall. Unit: none.");
      }
  }



  void
  LoadParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Gravity", gravity)(
      "Formulas of t separated by semicolons; empty: none. Unit: m / s^2.");
    add_parameter(prm, "Body force", body_force)(
      "Force per mass: formulas of x, y (, z), the initial positions X, Y (, "
      "Z) and t, separated by semicolons; empty: none. Unit: m / s^2.");
    add_parameter(prm, "Cundall damping", cundall, Double(0., 1.))(
      "Forces on the grid are reduced by this fraction where they speed it up "
      "and raised where they slow it down. Unit: none.");
    add_parameter(prm, "Kinetic damping", kinetic)(
      "The bodies without an imposed velocity stop where their kinetic energy "
      "has a maximum.");
    add_parameter(prm, "Damping end", damping_end)(
      "Damping of both kinds ends at this time; negative: never. Unit: s.");
  }



  void
  StageSections::declare_sections(ParameterHandler &prm)
  {
    declare_section(prm, "Time", time);
    declare_section(prm, "Scheme", scheme);
    declare_section(prm, "Walls", walls);
    declare_section(prm, "Loads", loads);
    declare_section(prm, "Implicit", implicit);
    declare_section(prm, "Newton", newton);
  }



  void
  StageParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Reset displacements", reset_displacements)(
      "Displacements are counted from the begin of this stage: where points "
      "are then is their initial position X, Y (, Z), in files and formulas.");
  }



  void
  TractionParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Shape", shape)(
      "The points that carry the traction: inside this shape initially (see "
      "Body/Shape; X is called x). Unit: m.");
    add_parameter(prm, "Traction", traction)(
      "Force per area: formulas of x, y (, z), the initial positions X, Y (, "
      "Z) and t, separated by semicolons. Unit: Pa.");
    add_parameter(prm, "Area", area, Double(0.))(
      "The area of the surface, shared by its points as their volumes. Unit: "
      "m^2 (2D: m).");
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
  ExactParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Displacement", displacement)(
      "Formulas of the initial positions X, Y (, Z) and t, separated by "
      "semicolons; empty: unknown. Unit: m.");
    add_parameter(prm, "Velocity", velocity)("Likewise. Unit: m / s.");
    add_parameter(prm, "Stress", stress)(
      "Likewise the Cauchy stress xx; yy; zz; xy (; xz; yz). Unit: Pa.");
  }



  void
  SweepParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Cells", cells, List(Integer(1)))(
      "Run with these numbers of cells in the direction that has most; others "
      "keep their ratio, one cell stays one cell. Empty: those of the grid. A "
      "run for each combination of this section's entries; no sweep if all are "
      "empty. Unit: none.");
    add_parameter(prm,
                  "Orders",
                  degrees,
                  List(Integer(1, SplineSpace<2>::max_degree)))(
      "Orders p to run; empty: that of the grid. Unit: none.");
    declare_other_names(prm, "Orders");
    add_parameter(prm,
                  "Formulations",
                  formulations,
                  List(Selection("updated Lagrangian|total Lagrangian")))(
      "Formulations to run; empty: that of the scheme.");
    add_parameter(prm, "Masses", masses)("Masses to run, each one of " +
                                         mass_names() +
                                         "; empty: that of the scheme.");
    add_parameter(prm,
                  "Quadratures",
                  quadratures,
                  List(Selection("points|least-squares|taylor-least-squares")))(
      "Quadratures to run; empty: that of the scheme.");
  }



  void
  ReferenceParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Surface file", surface_file)(
      "CSV beside the parameter file with the columns x, y of the free surface "
      "at the end, from the left to its front. Unit: m.");
    add_parameter(prm, "Failure line file", failure_line_file)(
      "CSV beside the parameter file with the columns x, y, in 2D, of a line "
      "above which the body has failed at the end; x grows. Unit: m.");
    add_parameter(prm,
                  "Failure displacement",
                  failure_displacement,
                  Double(0.))(
      "Points that have moved by more than this have failed. Unit: m.");
    add_parameter(prm, "Series file", series_file)(
      "CSV beside the parameter file with two columns: time and a value, in "
      "the units below.");
    add_parameter(prm, "Series quantity", series_quantity)(
      "The column of statistics.csv that the series is compared with.");
    add_parameter(prm, "Time unit", time_unit, Double(0.))(
      "Unit of the times of the series. Unit: s.");
    add_parameter(prm, "Value unit", value_unit, Double(0.))(
      "Unit of the values of the series, in that of the quantity.");
  }



  void
  OutputParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Directory", directory)(
      "Where results go. Empty: output/NAME.");
    add_parameter(prm,
                  "Earlier results",
                  earlier_results,
                  Selection("move aside|refuse|remove"))(
      "What becomes of results of an earlier run in the folder: move aside "
      "(into its folder earlier_1, earlier_2, ...), refuse (the run ends with "
      "a message), remove. Other files stay as they are.");
    add_parameter(prm, "Fields every", fields_every, Double(0.))(
      "Time between two .pvtu files; 0: initial and last state only. Unit: s.");
    add_parameter(prm, "Statistics every", statistics_every, Double(0.))(
      "Time between two lines of statistics.csv; 0: each step, which takes "
      "explicit steps up to twice as long. Unit: s.");
    add_parameter(prm, "Front above", front_above)(
      "Only points whose y is larger count for the columns front, front_99 and "
      "front_BODY, so that they are the run-out of what flows over a layer "
      "which reaches to the far wall. Where there is none, they are 0. Unit: "
      "m.");
    add_parameter(prm, "Grid fields", grid_fields)("Write the grid as well.");
    add_parameter(prm, "Surface points", surface_points)(
      "Write the points of loads on surfaces as well, if there are any: "
      "surface.pvd with velocity, displacement, load (Pa per initial area), "
      "area_vector (the normal times the area, both of today), area, the "
      "number of the load and that of its body.");
    add_parameter(prm, "Fields", fields, List(Selection(output_field_names())))(
      "Fields of points in .pvtu files: strain is Green's, size the edge of a "
      "cube of the volume of a point, for glyphs, history what materials keep "
      "(plastic_strain, for instance: greville --list history). "
      "Of the grid, which has velocity and mass anyway: acceleration, force "
      "(by "
      "stresses, gravity and loads, per function) and cell_class (as extended "
      "B-splines see cells: 0 empty, 1 cut, 2 well-filled, 3 inside).");
    add_parameter(prm, "Probes", probes)(
      "Initial positions, 'x, y; x, y; ...' (m): the point nearest to each is "
      "followed in probes.csv.");
    add_parameter(prm, "Load", load)(
      "Write how the work is shared among the processes to statistics.csv: "
      "largest_load (the largest work of a process, in units of that of a "
      "point), imbalance (over the mean), partitions (how often cells were "
      "shared anew). These columns depend on the number of processes.");
    add_parameter(prm, "Print times", print_times)(
      "Print what differs from run to run: progress and times.");
  }
} // namespace greville

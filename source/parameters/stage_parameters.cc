// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/base/parameters.h>
#include <greville/parameters/names.h>
#include <greville/parameters/stage_parameters.h>

#include <boost/algorithm/string/join.hpp>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  TimeParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Start", start)(
      "The initial time, of the first stage: a later one begins where the last "
      "one ends, and has no 'Start'. Unit: s.");
    add_parameter(prm, "End", end)(
      "Stages end one after the other: time runs on over them. Unit: s.");
    add_formula(prm, "Step", step)(
      "A formula of the smallest edge h of a cell (m) and the order p. Empty: "
      "from the CFL number and the critical step. Unit: s.");
    add_parameter(prm, "CFL number", cfl, Double(0.))(
      "An automatic step is at most this part of h / (c + |v|), with the speed "
      "c of pressure waves and v of points. Unit: none.");
    add_parameter(prm, "Safety", safety, Double(0., 1.))(
      "An automatic step is at most this fraction of the critical step. Unit: "
      "none.");
    add_parameter(prm, "Smallest step", smallest_step, Double(0., 1.))(
      "A run fails where an automatic step is below this fraction of the first "
      "one of its stage: where cells are crushed in total Lagrangian steps, "
      "for "
      "instance. Unit: none.");
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
      "mass, where accelerations show them to be too long. "
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
    add_formula(prm, "End when", end_when)(
      "A run ends after the row in which this formula of the columns of "
      "statistics.csv and probes.csv is true (not 0), such as 'time > 1 && "
      "kinetic < 1e-3'. Empty: never.");
    add_formula(prm, "Ramp until failure", ramp)(
      "A formula of t: the factor, such as that of 'Strength reduction', which "
      "grows in this stage until no equilibrium is found, 'End when' is true, "
      "or a point has moved by 'Largest displacement'. Implicit stages go back "
      "then, and halve the bracket of failure down to 'Implicit/Smallest "
      "step'; a failure in the first step of a stage, and in explicit stages, "
      "ends the run at once. The factor and its bracket are printed, and the "
      "states before and after failure written. Empty: no ramp.");
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
      "Mohr-Coulomb materials, with friction walls and with APIC, consistent "
      "otherwise and in total "
      "Lagrangian steps), consistent "
      "(the exact mass matrix on extended B-splines), lumped, or "
      "approximations of the exact one by K terms of a series: " +
      mass_names() + ".");
    add_parameter(prm, "Filling threshold", filling, Double(-1., 2.))(
      "Consistent mass and implicit steps: cells that points fill by this "
      "fraction of their volume or more are well-filled; B-splines that see no "
      "well-filled cell inside the body are extended from such cells. 0: none "
      "is extended. Negative: 0.45 in explicit and 0.55 in implicit updated "
      "Lagrangian steps, whose linear systems need fewer iterations then, and "
      "0.1 in total Lagrangian ones. Unit: none.");
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
      "When stresses are updated: last (USL), or last with velocities of the "
      "grid made anew from the points (MUSL).");
    add_parameter(prm, "Transfer", transfer, Selection("FLIP|PIC|APIC"))(
      "How points take their velocity from the grid.");
    add_parameter(prm, "FLIP share", flip, Double(0., 1.))(
      "The fraction of FLIP that the velocities of points keep in the time in "
      "which the fastest initial wave crosses a cell, the rest being PIC. 1: "
      "all of FLIP, 0: all of PIC. Unit: none.");
    add_parameter(prm, "Functions", functions, Selection("points|domains"))(
      "What points see of B-splines in updated Lagrangian steps: their values "
      "and gradients at the points, or averages over the domains of points, "
      "boxes that follow the deformation. With domains, errors keep falling "
      "with the cell size where points have moved. With the consistent mass "
      "and "
      "in implicit steps that are not quasi-static, values are those at the "
      "points.");
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
      "and loads and walls have given them, less what damping has taken, by a "
      "tenth of the largest energy or work of one source so far: an unstable "
      "step shows in this. Likewise where a contact of explicit steps has "
      "given "
      "so much to the bodies beyond what it has taken.");
    add_parameter(prm, "Points outside", outside, Selection("error|remove"))(
      "What to do about points that leave the grid.");
  }



  const std::array<std::string, 6> WallParameters::names = {
    {"Left", "Right", "Bottom", "Top", "Back", "Front"}};



  void
  WallParameters::declare(ParameterHandler &prm)
  {
    for (unsigned int w = 0; w < 6; ++w)
      {
        add_parameter(prm,
                      names[w],
                      type[w],
                      Selection("free|fixed|sliding|moving|friction|"
                                "periodic"))(
          "The walls of smallest x (Left), largest x (Right), smallest y "
          "(Bottom), largest y (Top), smallest z (Back) and largest z (Front): "
          "free, fixed (sticks), sliding (without friction), moving (with the "
          "velocity or displacement below), friction (sliding with the "
          "coefficient below, not with the consistent mass) or periodic (what "
          "leaves the grid here comes in "
          "at the wall on the other side, which is periodic, too; in all "
          "stages). A floor that contacts name is a rigid body.");
        add_formula(prm, names[w] + " region", region[w])(
          "Of a fixed, sliding or moving wall: the shape or condition in which "
          "it is, beside which it is free; empty: everywhere. Coefficients "
          "whose Greville abscissae are inside are held.");
        add_formula(prm, names[w] + " velocity", velocity[w])(
          "Of a moving wall: formulas of x, y (, z) and t separated by "
          "semicolons. A sliding wall may have one, of which the normal "
          "component counts. Unit: m / s.");
        add_formula(prm, names[w] + " displacement", displacement[w])(
          "In place of the velocity: formulas of x, y (, z) and t separated by "
          "semicolons, d(x, t). A step moves the wall by d(x, t + dt) - d(x, "
          "t). Unit: m.");
        add_parameter(prm, names[w] + " friction", friction[w], Double(0.))(
          "Coefficient of Coulomb friction of a friction wall. Unit: none.");
        add_formula(prm, names[w] + " pore pressure", pore_pressure[w])(
          "With 'Simulation/Pore water': the pressure of the water at this "
          "wall, a formula of x, y (, z) and t. Empty: no water passes. Unit: "
          "Pa.");
        add_parameter(prm, names[w] + " seepage face", seepage_face[w])(
          "Whether water only leaves where the pore pressure that is given at "
          "this wall is 0 or less (see 'Surface load NAME/Seepage face').");
        add_formula(prm, names[w] + " flux", flux[w])(
          "In place of a pore pressure: the water that leaves per area and "
          "time (negative: that comes), a formula of x, y (, z) and t. Unit: m "
          "/ s.");
      }
  }



  void
  LoadParameters::declare(ParameterHandler &prm)
  {
    add_formula(prm, "Gravity", gravity)(
      "Formulas of t separated by semicolons; empty: none. Unit: m / s^2.");
    add_formula(prm, "Body force", body_force)(
      "Force per mass: formulas of x, y (, z), the initial positions X, Y (, "
      "Z) and t, separated by semicolons; empty: none. Unit: m / s^2.");
    add_parameter(prm, "Cundall damping", cundall, Double(0., 1.))(
      "Forces on the grid are reduced by this fraction where they speed it up "
      "and raised where they slow it down. Unit: none.");
  }



  void
  ImplicitParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm,
                  "Spectral radius",
                  spectral_radius,
                  Patterns::Double(0., 1.))(
      "generalized-alpha: the factor by which a step changes the amplitude of "
      "the highest modes; 1 keeps them, 0 removes them. Unit: none.");
    add_parameter(prm,
                  "Smallest step",
                  smallest_step,
                  Patterns::Double(1e-12, 1.))(
      "A run ends where Newton's method fails with this fraction of "
      "'Time/Step'. Unit: none.");
  }



  void
  NewtonParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Tolerance", tolerance, Patterns::Double(1e-14, 1.))(
      "Newton's method ends where the residual is this fraction of the largest "
      "of the forces that it is the sum of: those of stresses, loads and "
      "inertia; or where it is round-off. Unit: none.");
    add_parameter(prm,
                  "Absolute tolerance",
                  absolute_tolerance,
                  Patterns::Double(0.))(
      "It ends, too, where the residual is smaller than this. Unit: N (2D: N / "
      "m).");
    add_parameter(prm,
                  "Maximum iterations",
                  max_iterations,
                  Patterns::Integer(1))(
      "A step that needs more is cut in halves. Unit: iterations.");
    add_parameter(prm,
                  "Largest linear tolerance",
                  largest_forcing,
                  Patterns::Double(0., 1.))(
      "Linear systems are solved to this relative residual at least, and the "
      "more exactly the faster Newton's method converges. Unit: none.");
    add_parameter(prm, "Print iterations", log, Patterns::Bool())(
      "Whether a line is printed for each iteration.");
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
    add_parameter(prm, "Bodies", bodies)(
      "Names of the bodies that are there in this stage, or all. Those that "
      "were not there before appear with the initial state of their sections; "
      "those that are not named are taken away, and do not come back.");
    add_parameter(prm, "Materials", materials)(
      "Other materials of bodies in this stage, such as 'clay: weak clay, "
      "wall: "
      "concrete'; all others have that of their section. Stresses stay.");
    add_parameter(prm, "Reset displacements", reset_displacements)(
      "Displacements are counted from the start of this stage: where points "
      "are then is their initial position X, Y (, Z), in files and formulas.");
  }
} // namespace greville

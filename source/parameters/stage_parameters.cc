// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/names.h>
#include <greville/parameters/stage_parameters.h>


namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  TimeParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Start", start)(
      "Initial time of the run. Stages have no 'Start' of their own. Unit: s.");
    add_parameter(prm, "End", end)("Time at the end of the run or stage. Time "
                                   "does not restart in stages. Unit: s.");
    add_formula(prm, "Step", step)(
      "Step size: a formula of the smallest edge h of a cell (m) and the order "
      "p. Empty: automatic, from the CFL number and the critical step. Unit: "
      "s.");
    add_parameter(prm, "CFL number", cfl, Double(0.))(
      "Largest automatic step over h / (c + |v|), with the speed c of pressure "
      "waves and the speed v of points. Unit: none.");
    add_parameter(prm, "Safety", safety, Double(0., 1.))(
      "Largest automatic step over the critical step. Unit: none.");
    add_parameter(prm,
                  "Too large step",
                  too_large_step,
                  Selection("refuse|warn|ignore"))(
      "Treatment of a given step above the critical one.");
    add_parameter(prm,
                  "Velocities at",
                  velocities,
                  Selection("half steps|full steps"))(
      "Time of velocities: the middle of a step (central differences, second "
      "order) or its end (symplectic Euler, first order).");
    add_parameter(prm, "Maximum steps", max_steps, Integer(0))(
      "Largest number of steps of the run; 0: no limit. Unit: steps.");
    add_parameter(prm,
                  "Largest displacement",
                  largest_displacement,
                  Double(0.))(
      "The run ends after the step in which a material point is further than "
      "this from its initial position (with 'Stage/Reset displacements': its "
      "position at the start of the stage). 0: no limit. Unit: m.");
    add_formula(prm, "End when", end_when)(
      "Condition that ends the run: a formula of the columns of statistics.csv "
      "and probes.csv, such as 'time > 1 && kinetic < 1e-3'. The run ends "
      "after the first row for which it is true. Empty: none.");
    add_formula(prm, "Ramp until failure", ramp)(
      "Factor that grows in this stage until failure, such as a strength "
      "reduction: a formula of t. Failure means that there is no equilibrium, "
      "that 'End when' is true, or that a point has moved by 'Largest "
      "displacement'. Implicit stages then go back and halve the bracket of "
      "the factor, down to 'Implicit/Smallest step'; explicit stages end at "
      "once, and so does a failure in the first step. The factor and its "
      "bracket are printed, and the states before and after failure are "
      "written. Empty: none.");
  }



  void
  SchemeParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm,
                  "Formulation",
                  formulation,
                  Selection("updated Lagrangian|total Lagrangian"))(
      "Positions at which basis functions are evaluated: the current positions "
      "of points, which move through the grid (updated Lagrangian, for flow "
      "and any deformation), or the initial ones (total Lagrangian, for "
      "solids). A total Lagrangian grid is in the initial configuration, walls "
      "act on this configuration, the mass matrix never changes, and bodies "
      "interact by contacts only.");
    add_parameter(prm, "Mass", mass)(
      "The mass M of M a = F: consistent (the exact mass matrix on extended "
      "B-splines), lumped, or fmpm-K (K terms of a series for the inverse of "
      "the consistent mass). auto: lumped for fluids, Drucker-Prager and "
      "Mohr-Coulomb materials, with friction walls, with APIC and with Taylor, "
      "otherwise and in total Lagrangian steps consistent. Values: " +
      mass_names() + ".");
    add_parameter(prm, "Filling threshold", filling, Double(-1., 2.))(
      "Smallest fraction of a well-filled cell that points fill, for the "
      "consistent mass and implicit steps. B-splines without a well-filled "
      "cell in their support are extended from well-filled cells. 0: no "
      "extension. Negative: 0.45 in explicit and 0.55 in implicit updated "
      "Lagrangian steps, 0.1 in total Lagrangian steps. Unit: none.");
    add_parameter(prm, "Filter", filter, Double(0., 100.))(
      "Strength of the high-order velocity filter of the consistent mass, "
      "which damps the modes that points excite when they cross cells: the "
      "fraction of the highest mode that is removed per crossed cell, five "
      "times as much for order 1. 0: no filter; steps then gain energy. Total "
      "Lagrangian steps need no filter. Unit: none.");
    add_parameter(prm,
                  "Stress update",
                  stress_update,
                  Selection(time_integrator_names()))(
      "When stresses are updated: last (USL), or last with velocities of the "
      "grid made anew from the points (MUSL).");
    add_parameter(prm, "Transfer", transfer, Selection("FLIP|PIC|APIC|Taylor"))(
      "Transfer of velocities between points and grid. Taylor: FLIP with the "
      "velocity gradients of the points. With lumped mass, APIC and Taylor "
      "keep "
      "linear velocities at the edges of the grid and in refined grids, which "
      "need one of them.");
    add_parameter(prm, "FLIP share", flip, Double(0., 1.))(
      "Fraction of FLIP in the velocity of points over the time in which the "
      "fastest initial wave crosses a cell; the rest is PIC. 1: FLIP, 0: PIC. "
      "Unit: none.");
    add_parameter(prm, "Functions", functions, Selection("points|domains"))(
      "Evaluation of B-splines in updated Lagrangian steps: values and "
      "gradients at the points, or averages over the domains of points, boxes "
      "that follow the deformation. With domains, errors keep falling with the "
      "cell size after points have moved. With the consistent mass and in "
      "dynamic implicit steps, domains average gradients only.");
    add_parameter(prm,
                  "Volumetric projection",
                  volumetric_projection,
                  Selection("none|order p-1|coarse mesh"))(
      "Remedy against locking of nearly incompressible bodies and plastic flow "
      "(F-bar): the ratio of volumes of the materials is projected on other "
      "B-splines. order p-1: one order less, which gives means over cells for "
      "order 1. coarse mesh: the same order on cells of twice the size, which "
      "gives smooth pressures.");
    add_parameter(prm,
                  "Energy gain",
                  energy_gain,
                  Selection("stop|warn|ignore"))(
      "Treatment of steps that gain energy: if the energy of the bodies "
      "exceeds their initial energy plus the work of loads and walls by a "
      "tenth of the largest energy or work so far, or if a contact of explicit "
      "steps has given as much to the bodies, the steps are unstable.");
    add_parameter(prm, "Points outside", outside, Selection("error|remove"))(
      "Treatment of points that leave the grid.");
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
          "Type of the walls at the smallest x (Left), largest x (Right), "
          "smallest y (Bottom), largest y (Top), smallest z (Back) and largest "
          "z (Front): free, fixed (no velocity), sliding (no normal velocity), "
          "moving (velocity or displacement below), friction (sliding with the "
          "coefficient below, not with the consistent mass) or periodic "
          "(together with the opposite wall; in all stages). A floor of "
          "contacts is a rigid body.");
        add_formula(prm, names[w] + " region", region[w])(
          "Part of a fixed, sliding or moving wall: a shape or a condition, "
          "outside of which the wall is free. Coefficients are constrained if "
          "their Greville abscissae are inside. Empty: the whole wall.");
        add_formula(prm, names[w] + " velocity", velocity[w])(
          "Velocity of a moving wall: formulas of x, y (, z) and t, separated "
          "by semicolons. A sliding wall can have a velocity, too, of which "
          "only the normal component counts. Unit: m / s.");
        add_formula(prm, names[w] + " displacement", displacement[w])(
          "Displacement d of a moving wall, in place of a velocity: formulas "
          "of x, y (, z) and t, separated by semicolons. A step moves the wall "
          "by d(x, t + dt) - d(x, t). Unit: m.");
        add_parameter(prm, names[w] + " friction", friction[w], Double(0.))(
          "Coefficient of Coulomb friction of a friction wall. Unit: none.");
        add_formula(prm, names[w] + " pore pressure", pore_pressure[w])(
          "Pore pressure at the wall, with 'Simulation/Pore water': a formula "
          "of x, y (, z) and t. Empty: impervious. Unit: Pa.");
        add_parameter(prm, names[w] + " seepage face", seepage_face[w])(
          "Seepage face, see 'Surface load NAME/Seepage face'.");
        add_formula(prm, names[w] + " flux", flux[w])(
          "Outflow of water per area and time (negative: inflow), in place of "
          "a pore pressure: a formula of x, y (, z) and t. Unit: m / s.");
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
      "Cundall's local damping: reduce forces on the grid by this fraction if "
      "they accelerate it, and increase them if they slow it down. Unit: "
      "none.");
  }



  void
  ImplicitParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Spectral radius", spectral_radius, Double(0., 1.))(
      "Factor by which a step of generalized-alpha changes the amplitude of "
      "the highest modes; 1 keeps them, 0 removes them. Unit: none.");
    add_parameter(prm, "Smallest step", smallest_step, Double(1e-12, 1.))(
      "Smallest step, as a fraction of 'Time/Step'. The run ends if Newton's "
      "method fails with this step. Unit: none.");
  }



  void
  NewtonParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Tolerance", tolerance, Double(1e-14, 1.))(
      "Newton's method ends if the residual is below this fraction of the "
      "largest of its terms, the forces of stresses, loads and inertia, or if "
      "it consists of round-off. Unit: none.");
    add_parameter(prm, "Absolute tolerance", absolute_tolerance, Double(0.))(
      "Newton's method also ends if the residual is smaller than this force. "
      "Unit: N (2D: N / m).");
    add_parameter(prm, "Maximum iterations", max_iterations, Integer(1))(
      "Largest number of iterations of Newton's method. A step that needs more "
      "is tried again with half of its length. Unit: iterations.");
    add_parameter(prm,
                  "Largest linear tolerance",
                  largest_forcing,
                  Double(0., 1.))(
      "Largest relative residual of linear systems. It decreases as Newton's "
      "method converges. Unit: none.");
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
      "Names of the bodies of this stage, or all. New bodies appear with the "
      "initial state of their sections. Bodies that are not named are removed "
      "for good.");
    add_parameter(prm, "Materials", materials)(
      "Materials of bodies that change in this stage, such as 'clay: weak "
      "clay, wall: concrete'. Stresses stay.");
    add_parameter(prm, "Reset displacements", reset_displacements)(
      "Count displacements from the start of this stage: the positions at this "
      "time become the initial positions X, Y (, Z), in files and formulas.");
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/consistent_mass.h>
#include <greville/simulation/parameters.h>
#include <greville/simulation/time_integrator.h>

namespace greville
{
  using namespace dealii;

  void
  GeneralParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Name", name, "Results go to output/NAME. Empty: the name of the file.");
    prm.add_parameter("Dimension",
                      dimension,
                      "2 (plane strain) or 3. Unit: none.",
                      Patterns::Integer(2, 3));
    prm.add_parameter("Bodies",
                      bodies,
                      "Names of bodies; each has a section 'Body NAME'.");
    prm.add_parameter(
      "Materials",
      materials,
      "Names of materials; each has a section 'Material NAME'.");
    prm.add_parameter(
      "Tractions",
      tractions,
      "Names of tractions; each has a section 'Traction NAME'.");
  }



  void
  GridParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Lower corner",
      lower,
      "Corner of the grid with the smallest coordinates. Unit: m.",
      Patterns::List(Patterns::Double(), 2, 3));
    prm.add_parameter("Upper corner",
                      upper,
                      "Corner with the largest coordinates. Unit: m.",
                      Patterns::List(Patterns::Double(), 2, 3));
    prm.add_parameter("Cells",
                      cells,
                      "Cells in each direction. Unit: none.",
                      Patterns::List(Patterns::Integer(1), 2, 3));
    prm.add_parameter("Order",
                      degree,
                      "Order p of the B-splines. Unit: none.",
                      Patterns::Integer(1, SplineSpace<2>::max_degree));
  }



  void
  TimeParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("End", end, "Unit: s.", Patterns::Double(0.));
    prm.add_parameter(
      "Step",
      step,
      "A formula of the smallest edge h of a cell (m) and the order p. Empty: "
      "from the CFL number and the critical step. Unit: s.");
    prm.add_parameter(
      "CFL number",
      cfl,
      "An automatic step is at most this part of h / (c + |v|), with the speed "
      "c of pressure waves and v of points. Unit: none.",
      Patterns::Double(0.));
    prm.add_parameter("Safety",
                      safety,
                      "An automatic step is at most this fraction of the "
                      "critical step. Unit: none.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Too large step",
                      too_large_step,
                      "What to do about a given step above the critical one.",
                      Patterns::Selection("refuse|warn|ignore"));
    prm.add_parameter(
      "Estimate every",
      estimate_every,
      "The critical step is estimated again after this number of steps, and "
      "after up to eight times as many while it changes by less than 2 %; 0: "
      "in the first step only. It is estimated again, too, where the largest "
      "wave speed has grown by 10 %, and, for automatic steps with consistent "
      "mass (not with USF), where accelerations show them to be too long. "
      "Unit: steps.",
      Patterns::Integer(0));
    prm.add_parameter(
      "Velocities at",
      velocities,
      "Velocities belong to the middle of a step (central differences, second "
      "order) or to its end (symplectic Euler, first order).",
      Patterns::Selection("half steps|full steps"));
    prm.add_parameter(
      "Maximum steps",
      max_steps,
      "A run ends after this number of steps; 0: no limit. Unit: steps.",
      Patterns::Integer(0));
  }



  void
  SchemeParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Mass",
      mass,
      "The mass M of M a = F: auto (lumped for fluids, Drucker-Prager and "
      "Mohr-Coulomb materials and with APIC, consistent otherwise), consistent "
      "(the exact mass matrix on extended B-splines), lumped, or fmpm-K (K = "
      "1, 2, ...).");
    prm.add_parameter(
      "Filling threshold",
      filling,
      "Consistent mass: cells that points fill by this part of their volume or "
      "more are well-filled; B-splines that see no well-filled cell inside the "
      "body are extended from such cells. 0: none is extended. Unit: none.",
      Patterns::Double(0., 2.));
    prm.add_parameter(
      "Filter",
      filter,
      "Consistent mass: strength of the high-order filter of the velocity, "
      "which damps what points that cross cells excite: the fraction of the "
      "highest mode that is removed per cell that is crossed, five times as "
      "much for order 1. 0: none; steps then gain energy. Unit: none.",
      Patterns::Double(0., 100.));
    prm.add_parameter(
      "Stress update",
      stress_update,
      "When stresses are updated: last (USL), first (USF), or last with "
      "velocities of the grid made anew from the points (MUSL).",
      Patterns::Selection(time_integrator_names()));
    prm.add_parameter("Transfer",
                      transfer,
                      "How points take their velocity from the grid.",
                      Patterns::Selection("FLIP|PIC|APIC"));
    prm.add_parameter(
      "FLIP share",
      flip,
      "The fraction of FLIP that the velocities of points keep in 'FLIP time', "
      "the rest being PIC: in a step dt it is the share to the power dt / "
      "'FLIP time'. 1: all of FLIP, 0: all of PIC. Unit: none.",
      Patterns::Double(0., 1.));
    prm.add_parameter("FLIP time",
                      flip_time,
                      "The time that 'FLIP share' belongs to. 0: in which the "
                      "fastest initial wave crosses a cell. Unit: s.",
                      Patterns::Double(0.));
    prm.add_parameter(
      "Quadrature",
      quadrature,
      "Integrals over the body by its points, or by Gauss points of full cells "
      "with density, momentum and stress reconstructed by least squares, or by "
      "Taylor least squares, which conserve mass and momentum cell by cell.",
      Patterns::Selection("points|least-squares|taylor-least-squares"));
    prm.add_parameter(
      "Full cell",
      full_cell,
      "For reconstructions: cells are full where their points have this part "
      "of their volume and no surface of the body cuts them. Others are "
      "integrated by points. Unit: none.",
      Patterns::Double(0., 2.));
    prm.add_parameter("Energy gain",
                      energy_gain,
                      "What to do where the bodies have more energy than they "
                      "had initially and loads and walls have given them, less "
                      "what damping has taken, which an unstable step shows.",
                      Patterns::Selection("stop|warn|ignore"));
    prm.add_parameter("Energy tolerance",
                      energy_tolerance,
                      "The gain that is accepted, as a fraction of the largest "
                      "energy so far. Unit: none.",
                      Patterns::Double(0.));
    prm.add_parameter("Points outside",
                      outside,
                      "What to do about points that leave the grid.",
                      Patterns::Selection("error|remove"));
  }



  void
  ConsistentSolverParameters::declare(ParameterHandler &prm)
  {
    SolverParameters::declare(prm);
    prm.add_parameter(
      "Method",
      method,
      "The solver of the consistent mass: conjugate gradients for all "
      "components together, preconditioned by IC(0) (cg-ic0, the fastest for "
      "mass matrices), by the cycle of 'p-multigrid' (cg-p-multigrid), by the "
      "diagonal (cg-jacobi), or not at all (cg).",
      Patterns::Selection(ConsistentMass<2>::methods()));
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
        prm.add_parameter(names[w],
                          type[w],
                          "The wall of " + std::string(places[w]) +
                            ": free, fixed (sticks), sliding (without "
                            "friction), moving (at the velocity below) or "
                            "friction (sliding with the coefficient below).",
                          Patterns::Selection(
                            "free|fixed|sliding|moving|friction"));
        prm.add_parameter(names[w] + " velocity",
                          velocity[w],
                          "Of a moving wall: formulas of t separated by "
                          "semicolons. Unit: m / s.");
        prm.add_parameter(
          names[w] + " friction",
          friction[w],
          "Coefficient of Coulomb friction of a friction wall. Unit: none.",
          Patterns::Double(0.));
      }
  }



  void
  LoadParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Gravity",
      gravity,
      "Formulas of t separated by semicolons; empty: none. Unit: m / s^2.");
    prm.add_parameter(
      "Body force",
      body_force,
      "Force per mass: formulas of x, y (, z), the initial positions X, Y (, "
      "Z) and t, separated by semicolons; empty: none. Unit: m / s^2.");
    prm.add_parameter(
      "Cundall damping",
      cundall,
      "Forces on the grid are reduced by this fraction where they speed it up "
      "and raised where they slow it down. Unit: none.",
      Patterns::Double(0., 1.));
    prm.add_parameter("Kinetic damping",
                      kinetic,
                      "The bodies without an imposed velocity stop where their "
                      "kinetic energy has a maximum.");
    prm.add_parameter(
      "Damping end",
      damping_end,
      "Damping of both kinds ends at this time; negative: never. Unit: s.");
  }



  void
  TractionParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Shape",
                      shape,
                      "The points that carry the traction: inside this shape "
                      "initially (see Body/Shape; X is called x). Unit: m.");
    prm.add_parameter(
      "Traction",
      traction,
      "Force per area: formulas of x, y (, z), the initial positions X, Y (, "
      "Z) and t, separated by semicolons. Unit: Pa.");
    prm.add_parameter("Area",
                      area,
                      "The area of the surface, shared by its points as their "
                      "volumes. Unit: m^2 (2D: m).",
                      Patterns::Double(0.));
  }



  void
  ExactParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Displacement",
                      displacement,
                      "Formulas of the initial positions X, Y (, Z) and t, "
                      "separated by semicolons; empty: unknown. Unit: m.");
    prm.add_parameter("Velocity", velocity, "Likewise. Unit: m / s.");
    prm.add_parameter(
      "Stress",
      stress,
      "Likewise the Cauchy stress xx; yy; zz; xy (; xz; yz). Unit: Pa.");
  }



  void
  SweepParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
      "Cells",
      cells,
      "Run with these numbers of cells in the direction that has most; others "
      "keep their ratio, one cell stays one cell. Empty: those of the grid. A "
      "run for each combination of this section's entries; no sweep if all are "
      "empty. Unit: none.",
      Patterns::List(Patterns::Integer(1)));
    prm.add_parameter("Orders",
                      degrees,
                      "Orders p to run; empty: that of the grid. Unit: none.",
                      Patterns::List(
                        Patterns::Integer(1, SplineSpace<2>::max_degree)));
    prm.add_parameter("Masses",
                      masses,
                      "Mass solvers to run; empty: that of the scheme.");
    prm.add_parameter("Quadratures",
                      quadratures,
                      "Quadratures to run; empty: that of the scheme.",
                      Patterns::List(Patterns::Selection(
                        "points|least-squares|taylor-least-squares")));
  }



  void
  ReferenceParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Surface file",
                      surface_file,
                      "CSV beside the parameter file with the columns x, y of "
                      "the free surface at the end. Unit: m.");
    prm.add_parameter("Series file",
                      series_file,
                      "CSV beside the parameter file with two columns: time "
                      "and a value, in the units below.");
    prm.add_parameter(
      "Series quantity",
      series_quantity,
      "The column of statistics.csv that the series is compared with.");
    prm.add_parameter("Time unit",
                      time_unit,
                      "Unit of the times of the series. Unit: s.",
                      Patterns::Double(0.));
    prm.add_parameter(
      "Value unit",
      value_unit,
      "Unit of the values of the series, in that of the quantity.",
      Patterns::Double(0.));
  }



  void
  OutputParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Directory",
                      directory,
                      "Where results go. Empty: output/NAME.");
    prm.add_parameter(
      "Fields every",
      fields_every,
      "Time between two .pvtu files; 0: initial and last state only. Unit: s.",
      Patterns::Double(0.));
    prm.add_parameter(
      "Statistics every",
      statistics_every,
      "Time between two lines of statistics.csv; 0: each step. Unit: s.",
      Patterns::Double(0.));
    prm.add_parameter("Grid fields", grid_fields, "Write the grid as well.");
    prm.add_parameter("Probes",
                      probes,
                      "Initial positions, 'x, y; x, y; ...' (m): the point "
                      "nearest to each is followed in probes.csv.");
    prm.add_parameter(
      "Print times",
      print_times,
      "Print what differs from run to run: progress and times.");
  }
} // namespace greville

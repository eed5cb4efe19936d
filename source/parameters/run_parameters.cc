// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
#include <greville/base/parameters.h>
#include <greville/parameters/names.h>
#include <greville/parameters/run_parameters.h>
#include <greville/points/point_fields.h>

#include <boost/algorithm/string/join.hpp>

namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  ExactParameters::declare(ParameterHandler &prm)
  {
    add_formula(prm, "Displacement", displacement)(
      "Formulas of the initial positions X, Y (, Z) and t, separated by "
      "semicolons; empty: unknown. Unit: m.");
    add_formula(prm, "Velocity", velocity)("Likewise. Unit: m / s.");
    add_formula(prm, "Stress", stress)(
      "Likewise the Cauchy stress xx; yy; zz; xy (; xz; yz). Unit: Pa.");
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
      "CSV beside the parameter file with two columns: time (s) and a value, "
      "in "
      "the unit of the quantity.");
    add_parameter(prm, "Series quantity", series_quantity)(
      "The column of statistics.csv that the series is compared with.");
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
    add_parameter(prm,
                  "Formulations",
                  formulations,
                  List(Selection("updated Lagrangian|total Lagrangian")))(
      "Formulations to run; empty: that of the scheme.");
    add_parameter(prm, "Masses", masses)("Masses to run, each one of " +
                                         mass_names() +
                                         "; empty: that of the scheme.");
    add_parameter(prm, "Parameter", parameter)(
      "A parameter to vary, as SECTION/PARAMETER: Material clay/Cohesion, for "
      "instance. Empty: none.");
    add_parameter(prm, "Values", values)(
      "The values of that parameter to run, separated by '|', each as it would "
      "stand in its section.");
    add_parameter(prm, "Processes per run", processes, Patterns::Integer(0))(
      "The processes are divided into groups of so many, and the runs among "
      "the groups, which run side by side; what a run prints is in its folder, "
      "output.txt. 0: all processes take one run after the other. Unit: none.");
  }



  std::vector<std::string>
  SweepParameters::list_of_values() const
  {
    return Utilities::split_string_list(values, '|');
  }



  bool
  SweepParameters::is_empty() const
  {
    return cells.empty() && degrees.empty() && formulations.empty() &&
           masses.empty() && parameter.empty();
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
    add_parameter(prm, "Points format", points_format, Selection("vtu|vtkhdf"))(
      "vtu: points.pvd with a file for each time and process. vtkhdf: all "
      "times "
      "of the points in one file, points.vtkhdf, with points.xdmf for ParaView "
      "5.11. Grid, surfaces and rigid bodies are .vtu files either way.");
    add_parameter(prm, "Statistics every", statistics_every)(
      "Time between two lines of statistics.csv; auto: a part in 400 of the "
      "time from the start to the end of the run; 0: each step. Unit: s.");
    add_parameter(prm, "Front above", front_above)(
      "Only points whose y is larger count for the columns front, front_99 and "
      "front_BODY, so that they are the run-out of what flows over a layer "
      "which reaches to the far wall. Where there is none, they are 0. Unit: "
      "m.");
    add_parameter(prm, "Grid fields", grid_fields)("Write the grid as well.");
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
      "followed in probes.csv, with position, velocity, stress and what "
      "'Fields' names. A shape, such as box(0, 0, 1, 1), stands for the mean "
      "over the points that are in it at the time, weighted by their initial "
      "volumes.");
    add_parameter(prm, "Load", load)(
      "Write how the work is shared among the processes to statistics.csv: "
      "largest_load (the largest work of a process, in units of that of a "
      "point), imbalance (over the mean), partitions (how often cells were "
      "shared anew). These columns depend on the number of processes.");
    add_parameter(prm, "Print times", print_times)(
      "Print what differs from run to run: progress and times.");
  }



  void
  CheckpointParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Every steps", every_steps, Patterns::Integer(0))(
      "Number of steps between two checkpoints; 0: none for this reason.");
    add_parameter(prm, "Every minutes", every_minutes, Patterns::Double(0.))(
      "Wall time between two checkpoints; 0: none for this reason. Unit: min. "
      "With one of the two there is one at the end of the run, too, for runs "
      "that start from there or go on beyond it.");
  }



  void
  LoadBalanceParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Threshold", threshold, Patterns::Double(0.))(
      "The cells of the grid are shared among the processes anew where the "
      "largest work of a process is more than this number times the mean. 0: "
      "never; 1: whenever they are compared. Unit: none.");
    add_parameter(prm, "Check every", check_every, Patterns::Integer(1))(
      "Number of steps between two comparisons.");
  }



  void
  LoadBalanceParameters::check() const
  {
    AssertThrow(threshold == 0. || threshold >= 1.,
                ExcMessage("The parameter 'Load balance/Threshold' is " +
                           text_of(threshold) +
                           ": the largest work of a process is at least the "
                           "mean, so it takes 1 or more, or 0 for never."));
  }
} // namespace greville

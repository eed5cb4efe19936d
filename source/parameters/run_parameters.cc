// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
#include <greville/parameters/names.h>
#include <greville/parameters/run_parameters.h>
#include <greville/points/point_fields.h>


namespace greville
{
  using namespace dealii;
  using namespace dealii::Patterns;

  void
  ExactParameters::declare(ParameterHandler &prm)
  {
    for (const auto &[name, formula] :
         {std::pair<std::string, std::string *>{"Displacement", &displacement},
          {"Velocity", &velocity},
          {"Stress", &stress}})
      add_formula(prm, name, *formula)(
        "Exact displacement (m), velocity (m / s), and Cauchy stress (Pa; xx; "
        "yy; zz; xy (; xz; yz)): formulas of the initial positions X, Y (, Z) "
        "and t, separated by semicolons. Empty: unknown.");
  }



  void
  ReferenceParameters::declare(ParameterHandler &prm)
  {
    for (const auto &[name, file] :
         {std::make_pair("Surface file", &surface_file),
          std::make_pair("Failure line file", &failure_line_file)})
      add_parameter(prm, name, *file)(
        "CSV file beside the parameter file with the columns x, y (2D) of a "
        "measured line at the end, from left to right: the surface up to its "
        "front, or the line above which the body has failed. Unit: m.");
    add_parameter(prm,
                  "Failure displacement",
                  failure_displacement,
                  Double(0.))(
      "Displacement beyond which a point counts as failed. Unit: m.");
    for (const auto &[name, text] :
         {std::pair<std::string, std::string *>{"Series file", &series_file},
          {"Series quantity", &series_quantity}})
      add_parameter(prm, name, *text)(
        "CSV file beside the parameter file with a measured series, time (s) "
        "and value, and the column of statistics.csv with which it is "
        "compared.");
  }



  void
  SweepParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Cells", cells, List(Integer(1)))(
      "Numbers of cells in the direction with most cells; other directions "
      "keep their ratio, and one cell stays one cell. Empty: 'Grid/Cells'. "
      "There is a run for each combination of this section's entries, and no "
      "sweep if all are empty. Unit: none.");
    add_parameter(prm,
                  "Orders",
                  degrees,
                  List(Integer(1, SplineSpace<2>::max_degree)))(
      "Orders p to run. Empty: 'Grid/Order'. Unit: none.");
    add_parameter(prm,
                  "Formulations",
                  formulations,
                  List(Selection("updated Lagrangian|total Lagrangian")))(
      "Formulations to run. Empty: 'Scheme/Formulation'.");
    add_parameter(prm, "Masses", masses)(
      "Masses to run, each one of " + mass_names() + ". Empty: 'Scheme/Mass'.");
    for (const auto &[name, text] :
         {std::pair<std::string, std::string *>{"Parameter", &parameter},
          {"Values", &values}})
      add_parameter(prm, name, *text)(
        "A parameter to vary, as SECTION/PARAMETER (Material clay/Cohesion, "
        "for "
        "instance), and the values to run, separated by '|', each as it would "
        "stand in its section. Empty: none.");
    add_parameter(prm, "Processes per run", processes, Patterns::Integer(0))(
      "Number of processes of each run. Runs go side by side, one for each "
      "group of processes; output.txt in the folder of a run has its messages. "
      "0: all processes take one run after the other. Unit: none.");
  }



  void
  OutputParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Directory", directory)(
      "Folder of results. Empty: output/NAME.");
    add_choice<EarlierResults>(prm,
                               "Earlier results",
                               earlier_results,
                               {{EarlierResults::move_aside, "move aside"},
                                {EarlierResults::refuse, "refuse"},
                                {EarlierResults::remove, "remove"}})(
      "Treatment of results of an earlier run in the folder: move aside (into "
      "the folder earlier_1, earlier_2, ...), refuse (end with a message), or "
      "remove. Other files stay.");
    add_parameter(prm, "Fields every", fields_every, Double(0.))(
      "Time between two files of fields; 0: initial and last state only. Unit: "
      "s.");
    add_parameter(prm, "Statistics every", statistics_every)(
      "Time between two rows of statistics.csv. auto: 1 / 400 of the time of "
      "the run; 0: each step. Unit: s.");
    add_parameter(prm, "Front above", runout_above)(
      "Smallest y of the points that count for the columns front, front_99 and "
      "front_BODY (the run-out), for flows over a layer that reaches the far "
      "wall. Without such points these columns are 0. Unit: m.");
    add_parameter(prm, "Grid fields", grid_fields)(
      "Write fields of the grid, too.");
    add_parameter(prm, "Fields", fields, List(Selection(output_field_names())))(
      "Fields of points in .vtu files: strain is Green's, size the edge of a "
      "cube of the volume of a point, for glyphs, history the variables of "
      "materials (plastic_strain, for instance: greville --list history), "
      "stress_jump the difference from a spline that the 'Indicator' of "
      "refined "
      "regions uses. "
      "Fields of the grid besides velocity and mass: acceleration, force (by "
      "stresses, gravity and loads, per function) and cell_class (the class of "
      "cells for extended B-splines: 0 empty, 1 cut, 2 well-filled, 3 "
      "inside).");
    add_parameter(prm, "Probes", probes)(
      "Probes of probes.csv: initial positions 'x, y; x, y; ...' (m), whose "
      "nearest points are followed with position, velocity, stress and the "
      "fields of 'Fields'; or shapes, such as box(0, 0, 1, 1), for the mean "
      "over the points inside at that time, weighted by initial volumes.");
    add_parameter(prm, "Load", load)(
      "Add the work of processes to statistics.csv: largest_load (the largest "
      "work of a process, in units of the work of a point), imbalance (the "
      "largest work over the mean), partitions (number of partitions so far). "
      "These columns depend on the number of processes.");
  }



  void
  CheckpointParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Every steps", every_steps, Patterns::Integer(0))(
      "Number of steps between two checkpoints; 0: no limit.");
    add_parameter(prm, "Every minutes", every_minutes, Patterns::Double(0.))(
      "Wall time between two checkpoints; 0: no limit. If one of 'Every "
      "minutes' and 'Every steps' is set, the end of the run has a checkpoint, "
      "too. Unit: min.");
  }



  void
  LoadBalanceParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Threshold", threshold, Patterns::Double(0.))(
      "Partition the grid anew if the largest work of a process exceeds the "
      "mean by this factor; the work is compared every 50 steps. 0: never; 1: "
      "partition in each step, for tests. Unit: none.");
  }



  void
  LoadBalanceParameters::check() const
  {
    Require(threshold == 0. || threshold >= 1.,
            "The parameter 'Load balance/Threshold' is " + text_of(threshold) +
              ": the largest work of a process is at least the mean, so it "
              "takes 1 or more, or 0 for never.");
  }
} // namespace greville

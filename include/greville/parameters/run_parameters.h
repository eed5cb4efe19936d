// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/utilities.h>

#include <greville/base/run_folder.h>

#include <algorithm>
#include <string>
#include <vector>

namespace greville
{
  /// Exact solutions for comparison.
  struct ExactParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string displacement;
    std::string velocity;
    std::string stress;
  };



  /// Measured data for comparison.
  struct ReferenceParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string surface_file;
    std::string failure_line_file;
    double      failure_displacement = 0.002;
    std::string series_file;
    std::string series_quantity = "front";
  };



  /// Several runs with different meshes or values of a parameter.
  struct SweepParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Return whether there is only one run.
    bool
    is_empty() const
    {
      return cells.empty() && degrees.empty() && formulations.empty() &&
             masses.empty() && parameter.empty();
    }

    std::vector<unsigned int> cells;
    std::vector<unsigned int> degrees;
    std::vector<std::string>  formulations;
    std::vector<std::string>  masses;
    std::string               parameter;
    std::string               values;
    unsigned int              processes = 0;
  };



  struct OutputParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Return the time between two rows of statistics in a run of this
    /// @p length, s; 0 for a row per step.
    double
    rows_every(const double length) const
    {
      return statistics_every == "auto" ? length / 400.
                                        : std::stod(statistics_every);
    }

    bool
    has_stress_jumps() const
    {
      return std::find(fields.begin(), fields.end(), "stress_jump") !=
             fields.end();
    }

    std::string              directory;
    EarlierResults           earlier_results  = EarlierResults::move_aside;
    double                   fields_every     = 0.;
    std::string              statistics_every = "auto";
    double                   runout_above     = -1e100;
    bool                     grid_fields      = true;
    std::vector<std::string> fields = dealii::Utilities::split_string_list(
      "velocity, displacement, stress, pressure, von_mises, J, density, body, "
      "id, size, history");
    std::string probes;
    bool        load = false;
  };



  /// The times at which a run writes checkpoints. The run also writes a
  /// checkpoint on SIGUSR1, SIGTERM, SIGINT and SIGHUP.
  struct CheckpointParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    unsigned int every_steps   = 0;
    double       every_minutes = 15.;
  };



  /// The times at which the cells of the grid are redistributed among the
  /// processes.
  struct LoadBalanceParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// Throw dealii::ExcMessage for invalid values.
    void
    check() const;

    /// Return the number of steps between two comparisons of the work.
    unsigned int
    steps_between_comparisons() const
    {
      return check_every > 0 ? check_every : threshold > 1. ? 50 : 1;
    }

    double threshold = 1.2;

    // Not set by files. 0 selects the default of steps_between_comparisons().
    unsigned int check_every = 0;
  };
} // namespace greville

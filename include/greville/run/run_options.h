// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/run/comparison.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace greville
{
  struct RampResult
  {
    /// Factors at the last equilibrium and at failure; infinity without
    /// failure.
    double from = 0., to = std::numeric_limits<double>::infinity();

    double
    factor() const
    {
      return std::isfinite(to) ? 0.5 * (from + to) : from;
    }
  };



  struct RunSummary
  {
    double wall_time = 0.; // s
    double runout    = 0.; // largest run-out, m
    double runout_99 = 0.; // largest Statistics::runout_99, m
    /// EnergyBalance::loss() of all parts, J (2D: J / m), and its ratio to the
    /// largest energy or work so far.
    double numerical_loss = 0., relative_loss = 0.;
    /// See BodyContacts::gains().
    std::vector<std::pair<std::string, double>> contact_gains;

    ExactErrors               errors;
    std::optional<RampResult> ramp;
  };



  struct RunOptions
  {
    /// Resume from the last checkpoint in the folder of the run.
    bool resumes = false;
    /// Folder of another run, whose last checkpoint gives bodies and surfaces;
    /// empty: none.
    std::string from;
    /// Parameters that replace parameters of the file, see
    /// read_parameter_lines().
    std::vector<std::string> settings;
    /// Function that all processes call once parameters and checkpoints are
    /// accepted, before the first file is written.
    std::function<void()> prepare_folder;
  };
} // namespace greville

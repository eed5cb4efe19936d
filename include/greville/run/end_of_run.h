// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace greville
{
  /// The conditions 'Time/End when' and 'Time/Ramp until failure' of the
  /// stages.
  class EndOfRun
  {
  public:
    /// @p columns are the columns of statistics.csv and probes.csv. Throws
    /// dealii::ExcMessage if a formula is wrong or compares a value that is
    /// always NaN, or if a factor decreases or is negative.
    EndOfRun(const SimulationParameters     &parameters,
             const std::vector<std::string> &columns);

    /// Return whether 'End when' of a stage holds for a @p row, with the values
    /// of the columns. Throws like Expression.
    bool
    holds(const unsigned int stage, const std::vector<double> &row) const;

    /// Return a side of a comparison in 'End when' of a stage that is NaN in
    /// the @p row, empty if there is none. The comparison is then false.
    std::string
    undefined(const unsigned int stage, const std::vector<double> &row) const;

    /// Return whether the factor of a stage grows until it fails.
    bool
    is_ramp(const unsigned int stage) const
    {
      return bool(stages[stage].factor);
    }

    bool
    has_ramp() const
    {
      return bool(any_factor);
    }

    /// Return the factor at a time; in stages without a ramp, the factor of the
    /// first stage with a ramp.
    double
    factor(const unsigned int stage, const double time) const;

    /// Return all formulas of 'End when'. A resumed run that had ended remains
    /// ended if they equal the formulas of its checkpoint.
    static std::string
    criteria(const std::string &parameters);

  private:
    struct Stage
    {
      std::optional<Expression> criterion, factor;
      /// The sides of comparisons, each with a formula that is false if the
      /// side is NaN.
      std::vector<std::pair<std::string, Expression>> compared;
    };

    static void
    make(Stage                          &result,
         const TimeParameters           &time,
         const std::vector<std::string> &names);

    std::vector<double>
    values_of(const std::vector<double> &row) const;

    std::vector<Stage>        stages;
    std::optional<Expression> any_factor;
    /// Indices in a row of the columns that formulas can name.
    std::vector<unsigned int> column_numbers;
  };



  /// The state of a ramp between two steps.
  template <typename States>
  struct Ramp
  {
    /// Earliest time of failure, s.
    double failed_at = std::numeric_limits<double>::infinity();
    /// States at failure and at the last equilibrium but one; empty if there is
    /// none.
    States failed, before;
    /// Reason why no equilibrium was found.
    std::string message;
  };
} // namespace greville

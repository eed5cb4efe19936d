// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_end_of_run_h
#define greville_run_end_of_run_h

#include <greville/base/expression.h>
#include <greville/parameters/simulation_parameters.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace greville
{
  /**
   * The conditions 'Time/End when' and 'Time/Ramp until failure' of the stages.
   */
  class EndOfRun
  {
  public:
    /**
     * @p columns are those of statistics.csv and probes.csv. Throws
     * dealii::ExcMessage where a formula is wrong, compares what is NaN
     * whatever the columns are, or is a factor that falls or is negative.
     */
    EndOfRun(const SimulationParameters     &parameters,
             const std::vector<std::string> &columns);

    /**
     * Return whether 'End when' of a stage holds for a @p row, with the values
     * of the columns. Throws as Expression.
     */
    bool
    holds(const unsigned int stage, const std::vector<double> &row) const;

    /**
     * Return the side of a comparison in 'End when' of a stage that is NaN in
     * the
     * @p row, so that the comparison is false; empty if there is none.
     */
    std::string
    undefined(const unsigned int stage, const std::vector<double> &row) const;

    /**
     * Return whether the factor of a stage grows until it fails.
     */
    bool
    is_ramp(const unsigned int stage) const
    {
      return bool(stages[stage].factor);
    }

    /**
     * Return whether a stage is a ramp.
     */
    bool
    has_ramp() const
    {
      return bool(any_factor);
    }

    /**
     * The factor at a time; in stages without a ramp that of the first one that
     * has one.
     */
    double
    factor(const unsigned int stage, const double time) const;

    /**
     * All formulas of 'End when', which a run that has ended by them compares
     * with those of a checkpoint.
     */
    static std::string
    criteria(const std::string &parameters);

  private:
    struct Stage
    {
      std::optional<Expression> criterion, factor;
      /// Sides of comparisons, and whether each equals itself: NaN does not.
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
    /// Places of the columns in a row: those whose names are words of formulas.
    std::vector<unsigned int> column_numbers;
  };



  /**
   * The state of a ramp between two steps.
   */
  template <typename States>
  struct Ramp
  {
    /// The earliest time at which there has been failure, s.
    double failed_at = std::numeric_limits<double>::infinity();
    /// The states of failure, and of the equilibrium before the last one; empty
    /// where there is none.
    States failed, before;
    /// Why no equilibrium has been found.
    std::string message;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/newton.h>

#include <chrono>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace greville
{
  /// A record of Newton's method in a step of length @p dt from @p time. If it
  /// has not converged, a shorter step follows. @p step and @p part count from
  /// 1; parts are bodies with grids of their own.
  struct NewtonRecord
  {
    unsigned int step = 0, part = 1;
    double       time = 0., dt = 0.;
    NewtonResult result;
  };



  /// Reports of a simulation besides its results: the seconds of its tasks on
  /// this process, warnings, cuts (the reasons for shortening a step), and
  /// records of Newton's method. A label such as " of 'Body disk'"
  /// distinguishes simulations in common steps.
  struct StepLog
  {
    /// Return the warnings, the cuts of the last step, or its records of
    /// Newton's method, and remove them.
    std::vector<std::string>
    take_warnings()
    {
      return std::exchange(warnings, {});
    }

    std::vector<std::string>
    take_cuts()
    {
      return std::exchange(cuts, {});
    }

    std::vector<NewtonRecord>
    take_newton()
    {
      return std::exchange(newton, {});
    }

    std::map<std::string, double> seconds; // of tasks, on this process
    std::vector<std::string>      warnings, cuts;
    std::string of; // label for messages and records: " of 'Body disk'"
    std::vector<NewtonRecord> newton;
  };



  inline double
  seconds_since(const std::chrono::steady_clock::time_point &begin)
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                         begin)
      .count();
  }



  /// Adds the duration of its lifetime to the seconds of a task.
  class PartTimer
  {
  public:
    PartTimer(StepLog &log, const std::string &part)
      : sum(log.seconds[part])
      , begin(std::chrono::steady_clock::now())
    {}

    PartTimer(const PartTimer &) = delete;
    PartTimer &
    operator=(const PartTimer &) = delete;

    ~PartTimer()
    {
      sum += seconds_since(begin);
    }

  private:
    double                               &sum;
    std::chrono::steady_clock::time_point begin;
  };
} // namespace greville

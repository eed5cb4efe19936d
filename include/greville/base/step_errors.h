// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/errors.h>

#include <stdexcept>
#include <string>

namespace greville
{
  /// Thrown by TimeIntegrator::try_step() if a shorter step should be tried.
  class StepRejected : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };



  /// Thrown if a step fails regardless of its length. The state is left as it
  /// is at that moment, so the caller must restore it.
  class StepFailed : public std::runtime_error
  {
  public:
    /// If materials may be the cause, @p by_materials adds information about
    /// them to messages.
    StepFailed(const std::string &message, const bool by_materials = true)
      : std::runtime_error(message)
      , by_materials(by_materials)
    {}

    const bool by_materials;
  };

  /// Thrown by Simulation::step() on all processes if a step fails; the state
  /// is the last good one.
  class StepGivenUp : public ErrorOnAll
  {
  public:
    using ErrorOnAll::ErrorOnAll;
  };

  /// Collective. Call an action, and throw StepFailed with its message if it
  /// throws ErrorOnAll. Other exceptions, of one process only, are not changed.
  template <typename Action>
  void
  fail_with(const Action &action, const bool by_materials = true)
  {
    try
      {
        action();
      }
    catch (const ErrorOnAll &error)
      {
        throw StepFailed(message_of(error), by_materials);
      }
  }

  /// Collective. Throw StepFailed on all processes, with the message of the
  /// first process whose @p message is not empty, if there is one.
  inline void
  fail_on_all(const std::string &message, const MPI_Comm comm)
  {
    fail_with([&]() { throw_on_all(message, comm); });
  }

  /// Collective. Call an action that does not involve materials, and throw
  /// StepFailed on all processes if it throws on any.
  template <typename Action>
  void
  run_or_fail(const MPI_Comm comm, const Action &action)
  {
    fail_with([&]() { run_on_all(comm, action); }, false);
  }

  /// Return a message without its final stop, so that it can be continued.
  inline std::string
  without_stop(std::string text)
  {
    while (!text.empty() && text.back() == '.')
      text.pop_back();
    return text;
  }
} // namespace greville

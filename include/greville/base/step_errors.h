// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_step_errors_h
#define greville_base_step_errors_h

#include <greville/base/errors.h>

#include <stdexcept>
#include <string>

namespace greville
{
  /**
   * Thrown by TimeIntegrator::try_step() where a shorter step is to be tried.
   */
  class StepRejected : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };



  /**
   * Thrown where a step fails whatever its length. It leaves the state behind
   * as it is then, so that the caller has to go back.
   */
  class StepFailed : public std::runtime_error
  {
  public:
    /**
     * Where materials can be the cause, @p by_materials tells messages to say
     * what is known of them.
     */
    StepFailed(const std::string &message, const bool by_materials = true)
      : std::runtime_error(message)
      , by_materials(by_materials)
    {}

    const bool by_materials;
  };

  /**
   * What Simulation::step() throws on all processes where a step fails: the
   * state is the last good one.
   */
  class StepGivenUp : public ErrorOnAll
  {
  public:
    using ErrorOnAll::ErrorOnAll;
  };

  /**
   * Collective. Call an action, and throw StepFailed with its message where it
   * throws ErrorOnAll. Other errors are those of one process, which the others
   * do not know of: they go on as they are.
   */
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

  /**
   * Collective. Throw StepFailed on all processes, with the message of the
   * first process whose @p message is not empty, if there is one.
   */
  inline void
  fail_on_all(const std::string &message, const MPI_Comm comm)
  {
    fail_with([&]() { throw_on_all(message, comm); });
  }

  /**
   * A message that goes on after what was its end.
   */
  inline std::string
  without_stop(std::string text)
  {
    while (!text.empty() && text.back() == '.')
      text.pop_back();
    return text;
  }
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

namespace greville
{
  /// Return the result of @p action. Exceptions are rethrown with the name of
  /// the @p stage before the message.
  template <typename Action>
  auto
  in_stage(const SimulationParameters &parameters,
           const unsigned int          stage,
           const Action               &action)
  {
    try
      {
        return action();
      }
    catch (const std::exception &exception)
      {
        AssertThrow(false,
                    ErrorOnAll(parameters.stage_text(stage) +
                               message_of(exception)));
        // Not reached.
        throw;
      }
  }
} // namespace greville

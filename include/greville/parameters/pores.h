// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/simulation_parameters.h>

#include <string>
#include <vector>

namespace greville
{
  /// Return whether any of the bodies has a material with pores in any stage. A
  /// group of bodies without pores that has its own grid is computed without
  /// pore water.
  bool
  has_pores(const SimulationParameters     &parameters,
            const std::vector<std::string> &bodies);

  /// Return whether a boundary prescribes the pore water pressure in the
  /// current stage.
  bool
  is_drained(const SimulationParameters &parameters);

  /// Return a sentence with the prescribed pressures and flows of water at
  /// boundaries in the current stage, for messages; empty if there are none.
  std::string
  describe_water_at_boundaries(const SimulationParameters &parameters);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <array>
#include <string>

namespace greville
{
  /// The parameters of the walls of the grid in a stage, by wall.
  struct WallParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    /// The names of the walls, in the order of the faces of a cell of deal.II.
    static const std::array<std::string, 6> names;

    std::array<std::string, 6> type{
      {"free", "free", "free", "free", "free", "free"}};
    std::array<std::string, 6> region;
    std::array<std::string, 6> velocity;
    std::array<std::string, 6> displacement;
    std::array<double, 6>      friction{};
    std::array<std::string, 6> pore_pressure;
    std::array<bool, 6>        seepage_face{};
    std::array<std::string, 6> flux;

    bool
    passes_water(const unsigned int wall) const
    {
      return !pore_pressure[wall].empty() || !flux[wall].empty();
    }

    bool
    is_free(const unsigned int wall) const
    {
      return type[wall] == "free";
    }

    bool
    is_periodic(const unsigned int wall) const
    {
      return type[wall] == "periodic";
    }
  };
} // namespace greville

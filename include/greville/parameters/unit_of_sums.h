// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/section_parameters.h>

#include <string>

namespace greville
{
  /// Return the unit of sums over points that have the @p unit in 3D: "N"
  /// becomes "N / m" in plane strain, and "N / rad" in axisymmetry.
  inline std::string
  unit_of_sums(const std::string    &unit,
               const unsigned int    dim,
               const GridParameters &grid)
  {
    return unit + (dim == 3 ? "" : grid.is_axisymmetric() ? " / rad" : " / m");
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/upper_triangle.h>

#include <vector>

namespace greville
{
  /// Matrices of the components of a field that differ in a few rows only,
  /// because some unknowns are constrained in some components only. Variant 0
  /// is stored elsewhere.
  struct RowVariants
  {
    /// The variant of each component; empty if all have variant 0.
    std::vector<unsigned int> of_component;

    /// By local unknown: 1 if its row differs between variants, on all
    /// processes that store it, else 0.
    std::vector<unsigned char> differs;

    /// The entries on this process of variants 1, 2, ... between unknowns whose
    /// rows differ. Other rows are empty.
    std::vector<UpperTriangle> matrices;

    /// By owned unknown: bit v says that it is constrained in variant v.
    std::vector<unsigned char> fixed;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/upper_triangle.h>

#include <vector>

namespace greville
{
  /// Matrices of the components of a field that are the same but for a few
  /// rows, because some unknowns are constrained in some components only.
  /// Variant 0 is a matrix that is given elsewhere.
  struct RowVariants
  {
    /// The variant of each component; empty if all have variant 0.
    std::vector<unsigned int> of_component;

    /// By local unknown: 1 if its row differs between variants, on all
    /// processes that store it, else 0.
    std::vector<unsigned char> differs;

    /// The entries of variants 1, 2, ... between unknowns whose rows differ, of
    /// this process; other rows are empty.
    std::vector<UpperTriangle> matrices;

    /// By owned unknown: bit v says that it is constrained in variant v.
    std::vector<unsigned char> fixed;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/upper_triangle.h>

#include <vector>

namespace greville
{
  /// Matrices of the components of a field. They differ only in a few rows,
  /// because some unknowns are constrained in some components. Variant 0 is
  /// stored elsewhere.
  struct RowVariants
  {
    /// The variant of each component; empty if all have variant 0.
    std::vector<unsigned int> of_component;

    /// For each local unknown, 1 if its row differs between variants, otherwise
    /// 0; equal on all processes that store it.
    std::vector<unsigned char> differs;

    /// The entries of variants 1, 2, ... on this process between unknowns whose
    /// rows differ. Other rows are empty.
    std::vector<UpperTriangle> matrices;

    /// For each owned unknown, bit v is set if it is constrained in variant v.
    std::vector<unsigned char> fixed;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/spline_space.h>

namespace greville
{
  /// The owned cells in groups for SIMD: a batch is a run of neighbours in x,
  /// one cell per lane. Consecutive batches are stacked in the last direction
  /// (y or z) and form *columns*, in which a loop can reuse results for
  /// coefficients that neighbours share. The groups depend on the mesh only and
  /// serve all orders of an OrderHierarchy.
  template <int dim>
  struct CellBatches
  {
    struct Batch
    {
      /// Number of the first cell in SplineSpace::owned_cells().
      unsigned int first_cell;
      /// Lanes [first_lane, end_lane) hold cells that no other batch holds;
      /// earlier lanes repeat cells of another batch, later lanes are empty.
      unsigned int first_lane;
      unsigned int end_lane;
      /// The lattice index of first_cell.
      MultiIndex<dim> index;
      /// True if the batch continues the column of the previous batch.
      bool continues_column;
    };

    /// Return the number of lanes: the doubles in a native vector of the
    /// machine for which the library was compiled.
    static unsigned int
    width();

    static std::vector<Batch>
    make(const SplineSpace<dim> &space);
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_cell_batches_h
#define greville_spline_cell_batches_h

#include <greville/spline/spline_space.h>

namespace greville
{
  /**
   * The owned cells in groups for SIMD: a batch is a run of neighbours in x,
   * one cell per lane. Batches that lie on each other in the last direction (y
   * or z) follow each other: they form *columns*, in which a loop can keep what
   * it computed for the coefficients that neighbours share. The groups depend
   * on the mesh only and so serve all orders of an OrderHierarchy.
   */
  template <int dim>
  struct CellBatches
  {
    struct Batch
    {
      /// Number of the first cell in SplineSpace::owned_cells().
      unsigned int first_cell;
      /// Lanes [first_lane, end_lane) hold cells that no other batch holds;
      /// lanes before are repeated from another batch, lanes behind are empty.
      unsigned int first_lane;
      unsigned int end_lane;
      /// The lattice index of first_cell.
      MultiIndex<dim> index;
      /// Whether the batch continues the column of the one before it.
      bool continues_column;
    };

    /**
     * Number of lanes: doubles in a native vector of the machine that the
     * library was compiled for.
     */
    static unsigned int
    width();

    /**
     * The batches of a space.
     */
    static std::vector<Batch>
    make(const SplineSpace<dim> &space);
  };
} // namespace greville

#endif

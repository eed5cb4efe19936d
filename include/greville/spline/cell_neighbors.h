// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_cell_neighbors_h
#define greville_spline_cell_neighbors_h

#include <greville/spline/spline_space.h>

namespace greville
{
  /**
   * Owned cells and those around them, and values that cells tell their
   * neighbours. Local numbers: owned cells as in the space, then those of the
   * ghost layer.
   */
  template <int dim>
  class CellNeighbors
  {
  public:
    /**
     * Collective. The space is that of any order.
     */
    void
    reinit(const SplineSpace<dim> &space);

    /**
     * Lexicographic positions of the local cells.
     */
    const std::vector<std::uint64_t> &
    positions() const
    {
      return cells;
    }

    /**
     * The local number of a cell at a position; invalid_unsigned_int where it
     * is not local.
     */
    unsigned int
    find(const std::uint64_t position) const;

    /**
     * The local number of the neighbor of a local cell on a side, 2 d or
     * 2 d + 1 in direction d; invalid_unsigned_int behind the sides of the
     * grid, and where it is not local.
     */
    unsigned int
    neighbor(const unsigned int cell, const unsigned int side) const;

    /**
     * Collective. Of each local cell, the owned ones given, the others are
     * overwritten by their owners.
     */
    void
    exchange(std::vector<double> &values) const;

  private:
    std::vector<std::uint64_t> cells;
    Lattice<dim>               lattice;

    // On several processes.
    std::vector<std::pair<std::uint64_t, unsigned int>> numbers;
    std::vector<unsigned int> places; // in the buffer, of local cells
    // Owned cells with the places of their children, if these are cells of the
    // mesh.
    std::vector<std::pair<unsigned int, unsigned int>> of_children;
    mutable VectorType                                 buffer;
    unsigned int                                       n_owned = 0;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_cell_neighbors_h
#define greville_spline_cell_neighbors_h

#include <greville/spline/spline_space.h>

namespace greville
{
  /**
   * Owned cells and their neighbours, with an exchange of values between them.
   * Local numbers: owned cells as in the space, followed by the cells of the
   * ghost layer.
   */
  template <int dim>
  class CellNeighbors
  {
  public:
    /// Collective. The space may have any order.
    void
    reinit(const SplineSpace<dim> &space);

    /// Return the lexicographic positions of the local cells.
    const std::vector<std::uint64_t> &
    positions() const
    {
      return cells;
    }

    /**
     * Return the local number of the cell at a position, or
     * invalid_unsigned_int if it is not local.
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

    // Local numbers by position; empty on one process.
    std::vector<std::pair<std::uint64_t, unsigned int>> numbers;
    std::vector<unsigned int> buffer_places; // of local cells in the buffer
    // Owned cells with the places of their children, if the children are the
    // cells of the mesh.
    std::vector<std::pair<unsigned int, unsigned int>> of_children;
    mutable VectorType                                 buffer;
    unsigned int                                       n_owned = 0;
  };
} // namespace greville

#endif

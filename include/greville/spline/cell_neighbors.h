// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/spline_space.h>

namespace greville
{
  /// Owned cells and their neighbours, with an exchange of values between them.
  /// Local numbers: owned cells as in the space, followed by the cells of the
  /// ghost layer.
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

    /// Return the local number of the cell at a position, or
    /// invalid_unsigned_int if it is not local.
    unsigned int
    find(const std::uint64_t position) const;

    /// Return the local number of the neighbor of a local cell on a side, 2 d
    /// or 2 d + 1 in direction d; invalid_unsigned_int if the side is a side of
    /// the grid, or the neighbor is not local.
    unsigned int
    neighbor(const unsigned int cell, const unsigned int side) const;

    /// Collective. Overwrite the @p values of local cells that are not owned by
    /// the values of their owners. Values must be exact as doubles.
    template <typename Value>
    void
    exchange(std::vector<Value> &values) const
    {
      AssertThrow(values.size() == cells.size(),
                  dealii::ExcDimensionMismatch(values.size(), cells.size()));
      if (buffer.size() == 0) // one process
        return;
      for (const auto &[cell, place] : sent)
        buffer.local_element(place) = values[cell];
      buffer.update_ghost_values();
      for (unsigned int c = n_owned; c < cells.size(); ++c)
        values[c] = Value(buffer.local_element(ghost_places[c - n_owned]));
    }

  private:
    /// Sort the cells by positions for find().
    void
    sort_cells();

    std::vector<std::uint64_t> cells;
    Lattice<dim>               lattice;

    // Local numbers by position, and where lines of cells in x begin among
    // them; empty on one process, unless cells have levels.
    std::vector<std::pair<std::uint64_t, unsigned int>> numbers;
    std::vector<unsigned int>                           line_begin;
    std::uint64_t                                       first_line = 0;

    // Places in the buffer, which has an entry for each cell: of the cells of
    // the ghost layer, and of the owned cells whose values are sent.
    std::vector<unsigned int>                          ghost_places;
    std::vector<std::pair<unsigned int, unsigned int>> sent;
    mutable VectorType                                 buffer;
    unsigned int                                       n_owned = 0;
  };
} // namespace greville

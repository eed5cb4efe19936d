// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace greville
{
  /// The refined cells of a CellHierarchy by their positions, ascending, the
  /// same on all processes.
  struct RefinedCells
  {
    std::vector<std::uint64_t> all;
    /// The cells that are refined only because of the surfaces of bodies.
    std::vector<std::uint64_t> at_surfaces;
  };



  /// The cells of a grid that changes, and their distribution among processes.
  /// This is given by the weights of the cells with points; other cells have
  /// the weight of a cell without points. On the same number of processes,
  /// p4est computes the same partition from the weights again.
  struct Partition
  {
    /// Collective. @p rows contains the lexicographic position of each cell
    /// (SplineSpace::owned_cells()) followed by its weight. Each cell may be on
    /// any one process. @p cells are kept.
    Partition(std::vector<double>                        rows,
              const MPI_Comm                             comm,
              const std::shared_ptr<const RefinedCells> &cells = nullptr);

    const std::vector<double> rows;
    /// The refined cells of a grid that changes in a run; null for others.
    const std::shared_ptr<const RefinedCells> cells;
    /// The number of rows on all processes, and their checksum, which does not
    /// depend on their order.
    std::uint64_t n_rows = 0, checksum = 0;

    bool
    is_same(const Partition &other) const
    {
      return n_rows == other.n_rows && checksum == other.checksum &&
             has_same_cells(other);
    }

    bool
    has_same_cells(const Partition &other) const
    {
      return cells == other.cells ||
             (cells && other.cells && cells->all == other.cells->all &&
              cells->at_surfaces == other.cells->at_surfaces);
    }
  };
} // namespace greville

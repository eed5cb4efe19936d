// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <vector>

namespace greville
{
  /// A distribution of cells among processes. It is given by the weights of the
  /// cells with points; other cells have the weight of a cell without points.
  /// On the same number of processes, p4est computes the same partition from
  /// the weights again.
  struct Partition
  {
    /// Collective. @p rows contains the lexicographic position of each cell
    /// (SplineSpace::owned_cells()) followed by its weight. Each cell may be on
    /// any one process.
    Partition(std::vector<double> rows, const MPI_Comm comm);

    const std::vector<double> rows;
    /// The number of rows on all processes, and their checksum, which does not
    /// depend on their order.
    std::uint64_t n_rows = 0, checksum = 0;

    bool
    is_same(const Partition &other) const
    {
      return n_rows == other.n_rows && checksum == other.checksum;
    }
  };
} // namespace greville

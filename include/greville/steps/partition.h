// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <vector>

namespace greville
{
  /// A distribution of cells among processes, given by weights of the cells
  /// with points, from which p4est computes the same partition again on the
  /// same number of processes. All other cells have the weight of a cell
  /// without points.
  struct Partition
  {
    /// Collective. @p rows has the lexicographic position of a cell
    /// (SplineSpace::owned_cells()) and its weight, one cell after the other,
    /// each on any one process.
    Partition(std::vector<double> rows, const MPI_Comm comm);

    const std::vector<double> rows;
    /// The number of rows on all processes, and a checksum of all rows in any
    /// order.
    std::uint64_t n_rows = 0, checksum = 0;

    bool
    is_same(const Partition &other) const
    {
      return n_rows == other.n_rows && checksum == other.checksum;
    }
  };
} // namespace greville

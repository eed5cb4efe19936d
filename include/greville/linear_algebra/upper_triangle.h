// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace greville
{
  /// An entry, with row <= column, of the diagonal blocks of a symmetric
  /// matrix; one value for each component.
  struct BlockEntry
  {
    unsigned int          row, column;
    std::array<double, 3> values;
  };

  /// The upper triangle of a symmetric matrix, by rows: the columns of each row
  /// begin with the diagonal and ascend. These rows are also the columns of the
  /// lower triangle.
  struct UpperTriangle
  {
    std::vector<std::size_t>  row_begin = {0};
    std::vector<unsigned int> columns;
    std::vector<double>       values;

    unsigned int
    size() const
    {
      return row_begin.size() - 1;
    }

    double
    diagonal(const unsigned int row) const
    {
      return values[row_begin[row]];
    }

    /// Add the means of @p n components of the entries, from @p component on.
    void
    add(const std::vector<BlockEntry> &entries,
        const unsigned int             component,
        const unsigned int             n);
  };

  /// Return the block diagonal matrix of several matrices. numbers[k] has the
  /// new numbers of the rows of matrix k, ascending; all together are 0, 1, ...
  UpperTriangle
  block_diagonal(const std::vector<UpperTriangle>             &matrices,
                 const std::vector<std::vector<unsigned int>> &numbers);
} // namespace greville

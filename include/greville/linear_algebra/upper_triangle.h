// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <cstddef>
#include <vector>

namespace greville
{
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
  };

} // namespace greville

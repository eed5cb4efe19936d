// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/linear_algebra/upper_triangle.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace greville
{
  void
  UpperTriangle::add(const std::vector<BlockEntry> &entries,
                     const unsigned int             component,
                     const unsigned int             n)
  {
    if (entries.empty())
      return;
    UpperTriangle sum;
    auto          entry = entries.begin();
    for (unsigned int row = 0; row < size(); ++row)
      {
        const auto append_until = [&](const unsigned int end) {
          for (; entry != entries.end() && entry->row == row &&
                 entry->column < end;
               ++entry)
            {
              const double *first = entry->values.data() + component;
              const double  mean  = std::accumulate(first, first + n, 0.) / n;
              if (!sum.columns.empty() &&
                  sum.columns.size() > sum.row_begin.back() &&
                  sum.columns.back() == entry->column)
                sum.values.back() += mean;
              else
                {
                  sum.columns.push_back(entry->column);
                  sum.values.push_back(mean);
                }
            }
        };
        for (std::size_t k = row_begin[row]; k < row_begin[row + 1]; ++k)
          {
            append_until(columns[k]);
            sum.columns.push_back(columns[k]);
            sum.values.push_back(values[k]);
            append_until(columns[k] + 1);
          }
        append_until(std::numeric_limits<unsigned int>::max());
        sum.row_begin.push_back(sum.columns.size());
      }
    *this = std::move(sum);
  }



  UpperTriangle
  block_diagonal(const std::vector<UpperTriangle>             &matrices,
                 const std::vector<std::vector<unsigned int>> &numbers)
  {
    std::vector<std::pair<unsigned int, unsigned int>> rows; // matrix, row
    for (const auto &of_matrix : numbers)
      rows.resize(rows.size() + of_matrix.size());
    for (unsigned int k = 0; k < numbers.size(); ++k)
      for (unsigned int row = 0; row < numbers[k].size(); ++row)
        rows[numbers[k][row]] = {k, row};
    UpperTriangle result;
    for (const auto &[k, row] : rows)
      {
        const UpperTriangle &matrix = matrices[k];
        for (std::size_t e = matrix.row_begin[row];
             e < matrix.row_begin[row + 1];
             ++e)
          {
            result.columns.push_back(numbers[k][matrix.columns[e]]);
            result.values.push_back(matrix.values[e]);
          }
        result.row_begin.push_back(result.columns.size());
      }
    return result;
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/linear_algebra/upper_triangle.h>

#include <algorithm>
#include <numeric>

namespace greville
{
  void
  append_row(UpperTriangle                                &matrix,
             std::vector<std::pair<unsigned int, double>> &row)
  {
    std::sort(row.begin(), row.end(), [](const auto &a, const auto &b) {
      return a.first < b.first;
    });
    for (std::size_t k = 0; k < row.size(); ++k)
      if (k > 0 && row[k].first == row[k - 1].first)
        matrix.values.back() += row[k].second;
      else
        {
          matrix.columns.push_back(row[k].first);
          matrix.values.push_back(row[k].second);
        }
    matrix.row_begin.push_back(matrix.columns.size());
  }



  UpperTriangle
  reorder(const UpperTriangle &matrix, const std::vector<unsigned int> &order)
  {
    const unsigned int        n = matrix.size();
    std::vector<unsigned int> row_of(n);
    for (unsigned int k = 0; k < n; ++k)
      row_of[order[k]] = k;

    // Transpose to columns and back to rows, so that columns ascend.
    const std::size_t         n_entries = matrix.columns.size();
    std::vector<std::size_t>  column_begin(n + 1, 0), next(n + 1, 0);
    std::vector<unsigned int> rows(n_entries);
    std::vector<double>       values(n_entries);
    const auto                for_each = [&](const auto &visit) {
      for (unsigned int i = 0; i < n; ++i)
        for (std::size_t e = matrix.row_begin[i]; e < matrix.row_begin[i + 1];
             ++e)
          {
            const unsigned int a = row_of[i], b = row_of[matrix.columns[e]];
            visit(std::min(a, b), std::max(a, b), e);
          }
    };
    UpperTriangle result;
    result.row_begin.assign(n + 1, 0);
    for_each([&](const unsigned int row,
                 const unsigned int column,
                 const std::size_t) {
      ++column_begin[column + 1];
      ++result.row_begin[row + 1];
    });
    std::partial_sum(column_begin.begin(),
                     column_begin.end(),
                     column_begin.begin());
    std::partial_sum(result.row_begin.begin(),
                     result.row_begin.end(),
                     result.row_begin.begin());
    next = column_begin;
    for_each([&](const unsigned int row,
                 const unsigned int column,
                 const std::size_t  e) {
      rows[next[column]]     = row;
      values[next[column]++] = matrix.values[e];
    });
    next = result.row_begin;
    result.columns.resize(n_entries);
    result.values.resize(n_entries);
    for (unsigned int column = 0; column < n; ++column)
      for (std::size_t e = column_begin[column]; e < column_begin[column + 1];
           ++e)
        {
          result.columns[next[rows[e]]]  = column;
          result.values[next[rows[e]]++] = values[e];
        }
    return result;
  }
} // namespace greville

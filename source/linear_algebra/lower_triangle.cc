// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/linear_algebra/lower_triangle.h>

#include <algorithm>
#include <numeric>

namespace greville
{
  LowerTriangle
  sum_entries(std::vector<std::vector<std::pair<unsigned int, double>>> &rows)
  {
    LowerTriangle sum;
    for (auto &row : rows)
      {
        std::sort(row.begin(), row.end(), [](const auto &a, const auto &b) {
          return a.first < b.first;
        });
        for (std::size_t k = 0; k < row.size(); ++k)
          if (k > 0 && row[k].first == row[k - 1].first)
            sum.values.back() += row[k].second;
          else
            {
              sum.columns.push_back(row[k].first);
              sum.values.push_back(row[k].second);
            }
        sum.row_begin.push_back(sum.columns.size());
      }
    return sum;
  }



  LowerTriangle
  reorder(const LowerTriangle &matrix, const std::vector<unsigned int> &order)
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
            visit(std::max(a, b), std::min(a, b), e);
          }
    };
    LowerTriangle result;
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



  LowerTriangle
  with_fill(const LowerTriangle &matrix, const unsigned int n_eliminated)
  {
    // Rows below the diagonal of each column.
    const unsigned int       n = matrix.size();
    std::vector<std::size_t> column_begin(n + 1, 0);
    for (const unsigned int column : matrix.columns)
      ++column_begin[column + 1];
    std::partial_sum(column_begin.begin(),
                     column_begin.end(),
                     column_begin.begin());
    std::vector<unsigned int> rows(matrix.columns.size());
    auto                      next = column_begin;
    for (unsigned int i = 0; i < n; ++i)
      for (std::size_t e = matrix.row_begin[i]; e < matrix.row_begin[i + 1];
           ++e)
        rows[next[matrix.columns[e]]++] = i;

    LowerTriangle             result;
    std::vector<double>       values(n, 0.);
    std::vector<unsigned int> last_row_with(n, static_cast<unsigned int>(-1));
    std::vector<unsigned int> row;
    for (unsigned int i = 0; i < n; ++i)
      {
        row.clear();
        const auto see = [&](const unsigned int j) {
          if (last_row_with[j] != i)
            {
              last_row_with[j] = i;
              row.push_back(j);
            }
        };
        for (std::size_t e = matrix.row_begin[i]; e < matrix.row_begin[i + 1];
             ++e)
          {
            const unsigned int k = matrix.columns[e];
            see(k);
            values[k] = matrix.values[e];
            if (k < n_eliminated)
              for (std::size_t f = column_begin[k];
                   f < column_begin[k + 1] && rows[f] < i;
                   ++f)
                see(rows[f]);
          }
        std::sort(row.begin(), row.end());
        for (const unsigned int j : row)
          {
            result.columns.push_back(j);
            result.values.push_back(values[j]);
            values[j] = 0.;
          }
        result.row_begin.push_back(result.columns.size());
      }
    return result;
  }
} // namespace greville

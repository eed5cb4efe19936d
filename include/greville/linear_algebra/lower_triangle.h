// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_linear_algebra_lower_triangle_h
#define greville_linear_algebra_lower_triangle_h

#include <cstddef>
#include <utility>
#include <vector>

namespace greville
{
  /**
   * The lower triangle of a symmetric matrix, by rows: the columns of each row
   * ascend and end with the diagonal.
   */
  struct LowerTriangle
  {
    std::vector<std::size_t>  row_begin = {0};
    std::vector<unsigned int> columns;
    std::vector<double>       values;

    unsigned int
    size() const
    {
      return row_begin.size() - 1;
    }
  };



  /**
   * Return the matrix of the sums of the entries (column, value) of each row,
   * which may be in any order. Each row must have an entry on the diagonal.
   */
  LowerTriangle
  sum_entries(std::vector<std::vector<std::pair<unsigned int, double>>> &rows);

  /**
   * Return the matrix with rows and columns in another order: row k of the
   * result is row order[k].
   */
  LowerTriangle
  reorder(const LowerTriangle &matrix, const std::vector<unsigned int> &order);

  /**
   * Return the matrix with additional zeros where the elimination of one of the
   * first @p n_eliminated rows couples two others: its IC(0) is IC(1).
   */
  LowerTriangle
  with_fill(const LowerTriangle &matrix, const unsigned int n_eliminated);
} // namespace greville

#endif

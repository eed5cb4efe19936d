// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/paper/ilut.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

namespace greville
{
  using namespace dealii;

  /// The row in work, by column, and the columns that are set.
  struct ILUT::Row
  {
    explicit Row(const unsigned int n)
      : values(n, 0.)
      , is_set(n, 0)
    {}

    /// Take row @p i of the matrix, and return its Euclidean norm.
    double
    load(const Mat matrix, const unsigned int i)
    {
      PetscInt           n_columns;
      const PetscInt    *numbers;
      const PetscScalar *entries;
      check_petsc(MatGetRow(matrix, i, &n_columns, &numbers, &entries));
      double square = 0.;
      n_lower = n_upper = 0;
      columns.clear();
      for (PetscInt k = 0; k < n_columns; ++k)
        {
          const unsigned int j = numbers[k];
          square += entries[k] * entries[k];
          add(j, entries[k], i);
          n_lower += j < i;
          n_upper += j > i;
        }
      check_petsc(MatRestoreRow(matrix, i, &n_columns, &numbers, &entries));
      return std::sqrt(square);
    }

    /// Eliminate the entries before column @p i, or drop small ones.
    void
    eliminate(const unsigned int         i,
              const Triangle            &upper,
              const std::vector<double> &inverse_diagonal,
              const double               drop_tolerance)
    {
      while (!to_eliminate.empty())
        {
          const unsigned int k = to_eliminate.top();
          to_eliminate.pop();
          const double factor = values[k] * inverse_diagonal[k];
          if (std::abs(factor) <= drop_tolerance)
            {
              values[k] = 0.;
              continue;
            }
          values[k] = factor;
          for (std::size_t l = upper.begin[k]; l < upper.begin[k + 1]; ++l)
            {
              const unsigned int j = upper.columns[l];
              if (!is_set[j])
                add(j, 0., i);
              values[j] -= factor * upper.values[l];
            }
        }
    }

    /// Append the @p n_max largest of the entries that a function accepts.
    template <typename Accepts>
    void
    append_to(Triangle         &triangle,
              const std::size_t n_max,
              const Accepts    &accepts) const
    {
      using Entry = std::pair<unsigned int, double>;
      std::vector<Entry> kept;
      for (const unsigned int j : columns)
        if (accepts(j, values[j]))
          kept.emplace_back(j, values[j]);
      if (kept.size() > n_max)
        {
          std::nth_element(kept.begin(),
                           kept.begin() + n_max,
                           kept.end(),
                           [](const Entry &a, const Entry &b) {
                             return std::abs(a.second) > std::abs(b.second);
                           });
          kept.resize(n_max);
        }
      std::sort(kept.begin(), kept.end(), [](const Entry &a, const Entry &b) {
        return a.first < b.first;
      });
      for (const Entry &entry : kept)
        {
          triangle.columns.push_back(entry.first);
          triangle.values.push_back(entry.second);
        }
      triangle.begin.push_back(triangle.columns.size());
    }

    void
    add(const unsigned int j, const double value, const unsigned int i)
    {
      is_set[j] = 1;
      values[j] = value;
      columns.push_back(j);
      if (j < i)
        to_eliminate.push(j);
    }

    std::vector<double>        values;
    std::vector<unsigned char> is_set;
    std::vector<unsigned int>  columns;
    unsigned int               n_lower = 0, n_upper = 0; // in the matrix
    std::priority_queue<unsigned int,
                        std::vector<unsigned int>,
                        std::greater<unsigned int>>
      to_eliminate;
  };



  ILUT::ILUT(const Mat    matrix,
             const double drop_tolerance,
             const double fill_factor)
  {
    PetscInt n;
    check_petsc(MatGetLocalSize(matrix, &n, nullptr));
    inverse_diagonal.reserve(n);
    Row row(n);
    for (unsigned int i = 0; i < static_cast<unsigned int>(n); ++i)
      {
        const double norm = row.load(matrix, i), least = drop_tolerance * norm;
        row.eliminate(i, upper, inverse_diagonal, drop_tolerance);
        const unsigned int half = (row.n_lower + row.n_upper) / 2;
        row.append_to(lower,
                      fill_factor * std::max(row.n_lower, half),
                      [&](const unsigned int j, const double value) {
                        return j < i && value != 0.;
                      });
        row.append_to(upper,
                      fill_factor * std::max(row.n_upper, half),
                      [&](const unsigned int j, const double value) {
                        return j > i && std::abs(value) > least;
                      });
        Require(row.is_set[i] && std::abs(row.values[i]) > 1e-15 * norm,
                "ILUT found a vanishing pivot in row " + std::to_string(i) +
                  " of " + std::to_string(n) + ".");
        inverse_diagonal.push_back(1. / row.values[i]);
        for (const unsigned int j : row.columns)
          row.is_set[j] = 0;
      }
  }



  void
  ILUT::solve(double *x) const
  {
    const unsigned int n = inverse_diagonal.size();
    for (unsigned int i = 0; i < n; ++i)
      for (std::size_t k = lower.begin[i]; k < lower.begin[i + 1]; ++k)
        x[i] -= lower.values[k] * x[lower.columns[k]];
    for (unsigned int i = n; i-- > 0;)
      {
        for (std::size_t k = upper.begin[i]; k < upper.begin[i + 1]; ++k)
          x[i] -= upper.values[k] * x[upper.columns[k]];
        x[i] *= inverse_diagonal[i];
      }
  }



  void
  ILUT::solve_transpose(double *x) const
  {
    const unsigned int n = inverse_diagonal.size();
    for (unsigned int i = 0; i < n; ++i)
      {
        x[i] *= inverse_diagonal[i];
        for (std::size_t k = upper.begin[i]; k < upper.begin[i + 1]; ++k)
          x[upper.columns[k]] -= upper.values[k] * x[i];
      }
    for (unsigned int i = n; i-- > 0;)
      for (std::size_t k = lower.begin[i]; k < lower.begin[i + 1]; ++k)
        x[lower.columns[k]] -= lower.values[k] * x[i];
  }
} // namespace greville

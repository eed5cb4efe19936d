// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/paper/ilut.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

namespace greville
{
  using namespace dealii;

  ILUT::ILUT(const Mat    matrix,
             const double drop_tolerance,
             const double fill_factor)
  {
    PetscInt n;
    check_petsc(MatGetLocalSize(matrix, &n, nullptr));
    inverse_diagonal.reserve(n);

    using Entry = std::pair<unsigned int, double>;
    std::vector<double>        row(n, 0.); // the row in work, by column
    std::vector<unsigned char> is_set(n, 0);
    std::vector<unsigned int>  in_row;
    std::vector<Entry>         kept;
    std::priority_queue<unsigned int,
                        std::vector<unsigned int>,
                        std::greater<unsigned int>>
      to_eliminate;

    // Keep the largest entries, ordered by column.
    const auto append = [&](Triangle &triangle, const std::size_t n_max) {
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
    };

    for (unsigned int i = 0; i < static_cast<unsigned int>(n); ++i)
      {
        PetscInt           n_columns;
        const PetscInt    *columns;
        const PetscScalar *values;
        check_petsc(MatGetRow(matrix, i, &n_columns, &columns, &values));
        double       norm    = 0.;
        unsigned int n_lower = 0, n_upper = 0;
        in_row.clear();
        for (PetscInt k = 0; k < n_columns; ++k)
          {
            const unsigned int j = columns[k];
            norm += values[k] * values[k];
            row[j]    = values[k];
            is_set[j] = 1;
            in_row.push_back(j);
            if (j < i)
              {
                to_eliminate.push(j);
                ++n_lower;
              }
            else if (j > i)
              ++n_upper;
          }
        check_petsc(MatRestoreRow(matrix, i, &n_columns, &columns, &values));
        norm                   = std::sqrt(norm);
        const double threshold = drop_tolerance * norm;

        while (!to_eliminate.empty())
          {
            const unsigned int k = to_eliminate.top();
            to_eliminate.pop();
            const double factor = row[k] * inverse_diagonal[k];
            if (std::abs(factor) <= drop_tolerance)
              {
                row[k] = 0.;
                continue;
              }
            row[k] = factor;
            for (std::size_t l = upper.begin[k]; l < upper.begin[k + 1]; ++l)
              {
                const unsigned int j = upper.columns[l];
                if (!is_set[j])
                  {
                    is_set[j] = 1;
                    row[j]    = 0.;
                    in_row.push_back(j);
                    if (j < i)
                      to_eliminate.push(j);
                  }
                row[j] -= factor * upper.values[l];
              }
          }

        const unsigned int half = (n_lower + n_upper) / 2;
        const auto         keep = [&](const bool is_lower) {
          kept.clear();
          for (const unsigned int j : in_row)
            if (is_lower ? (j < i && row[j] != 0.)
                                 : (j > i && std::abs(row[j]) > threshold))
              kept.emplace_back(j, row[j]);
        };
        keep(true);
        append(lower, fill_factor * std::max(n_lower, half));
        keep(false);
        append(upper, fill_factor * std::max(n_upper, half));

        AssertThrow(is_set[i] && std::abs(row[i]) > 1e-15 * norm,
                    ExcMessage("ILUT found a vanishing pivot in row " +
                               std::to_string(i) + " of " + std::to_string(n) +
                               "."));
        inverse_diagonal.push_back(1. / row[i]);
        for (const unsigned int j : in_row)
          is_set[j] = 0;
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

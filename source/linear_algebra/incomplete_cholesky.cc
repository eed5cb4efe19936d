// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>

#include <greville/base/errors.h>
#include <greville/base/largest_eigenvalue.h>
#include <greville/base/simd.h>
#include <greville/base/with_width.h>
#include <greville/linear_algebra/incomplete_cholesky.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Smaller pivots of the scaled matrix are round-off, or result from dropped
    // fill. If they are far below zero, the factors grow without bound.
    constexpr double smallest_pivot = 3e-5;
    constexpr double lowest_pivot   = -0.1;

    // The smallest shift; and the largest shift that bounds eigenvalues of the
    // preconditioned matrix. Larger shifts would cost more iterations than they
    // save.
    constexpr double first_shift       = 1e-3;
    constexpr double largest_remedy    = 4e-3;
    constexpr double largest_tolerable = 2.;
  } // namespace



  namespace
  {
    /// The finished columns of a factor, sorted by the row of their next entry.
    class ColumnsByRow
    {
    public:
      ColumnsByRow(const unsigned int n)
        : head(n, none)
        , link(n, none)
        , next_entry(n)
      {}

      /// Insert a column whose next @p entry is in a row.
      void
      insert(const unsigned int column,
             const unsigned int row,
             const std::size_t  entry)
      {
        next_entry[column] = entry;
        link[column]       = head[row];
        head[row]          = column;
      }

      /// Call visit(column, entry) for each column whose next entry is in a
      /// row. visit() may insert the column again, in a later row.
      template <typename Visit>
      void
      take(const unsigned int row, const Visit &visit)
      {
        for (unsigned int column = head[row]; column != none;)
          {
            const unsigned int next = link[column];
            visit(column, next_entry[column]);
            column = next;
          }
      }

    private:
      static constexpr unsigned int none = static_cast<unsigned int>(-1);

      std::vector<unsigned int> head, link;
      std::vector<std::size_t>  next_entry;
    };
  } // namespace



  void
  IncompleteCholesky::factorize(const UpperTriangle      &matrix,
                                const CholeskyParameters &parameters,
                                const unsigned int        n_columns)
  {
    const unsigned int  n = matrix.size();
    std::vector<double> scaling(n);
    largest_diagonal = 0.;
    for (unsigned int i = 0; i < n; ++i)
      {
        const double diagonal = matrix.diagonal(i);
        Require(
          diagonal > 0. && std::isfinite(diagonal),
          "A Cholesky factorization needs a positive diagonal, but entry " +
            std::to_string(i) + " is " + std::to_string(diagonal) + ".");
        scaling[i]       = 1. / std::sqrt(diagonal);
        largest_diagonal = std::max(largest_diagonal, diagonal);
      }
    if (!(largest_diagonal > 0.))
      largest_diagonal = 1.;
    used_shift       = parameters.shift;
    const auto fails = [&]() {
      if (!factorize_columns(
            matrix, scaling, parameters.drop_tolerance, n_columns))
        return true;
      undo_scaling(scaling);
      return parameters.drop_tolerance == 0. && used_shift < largest_remedy &&
             largest_eigenvalue(matrix) > largest_tolerable;
    };
    while (fails())
      {
        used_shift = std::max(2. * used_shift, first_shift);
        Require(used_shift <= parameters.largest_shift,
                "An incomplete Cholesky factorization fails with all shifts: "
                "the matrix is not positive definite.");
      }
  }



  bool
  IncompleteCholesky::factorize_columns(const UpperTriangle       &matrix,
                                        const std::vector<double> &scaling,
                                        const double       drop_tolerance,
                                        const unsigned int n_columns)
  {
    // Column k of the factor C of the scaled matrix A = S M S = C C^T:
    //   C_ik = (A_ik - sum_(j<k) C_ij C_kj) / C_kk.
    const unsigned int n = matrix.size();
    n_raised_pivots      = 0;
    column_begin.assign(1, 0);
    rows.clear();
    entries.clear();
    inverse_pivots.assign(n_columns, 0.f);
    ColumnsByRow              finished(n);
    std::vector<double>       column(n);
    std::vector<unsigned int> last_column_with(n,
                                               static_cast<unsigned int>(-1));
    std::vector<unsigned int> touched;
    for (unsigned int k = 0; k < n_columns; ++k)
      {
        touched.clear();
        const auto touch = [&](const unsigned int i, const double value) {
          last_column_with[i] = k;
          column[i]           = value;
          touched.push_back(i);
        };
        for (std::size_t e = matrix.row_begin[k] + 1;
             e < matrix.row_begin[k + 1];
             ++e)
          {
            const unsigned int i = matrix.columns[e];
            touch(i, matrix.values[e] * scaling[k] * scaling[i]);
          }
        double pivot = 1. + used_shift;
        finished.take(k, [&](const unsigned int j, const std::size_t entry) {
          const double factor = entries[entry];
          pivot -= factor * factor;
          const std::size_t end = column_begin[j + 1];
          // Entries outside of the pattern are changed, too, but touch() sets
          // an entry before it is used.
          for (std::size_t e = entry + 1; e < end && drop_tolerance == 0.; ++e)
            column[rows[e]] -= factor * entries[e];
          for (std::size_t e = entry + 1; e < end && drop_tolerance > 0.; ++e)
            if (last_column_with[rows[e]] == k)
              column[rows[e]] -= factor * entries[e];
            else
              touch(rows[e], -factor * entries[e]);
          if (entry + 1 < end)
            finished.insert(j, rows[entry + 1], entry + 1);
        });
        if (!(pivot > lowest_pivot))
          return false;
        if (pivot < smallest_pivot)
          {
            pivot = smallest_pivot;
            ++n_raised_pivots;
          }
        const double inverse_root = 1. / std::sqrt(pivot);
        if (drop_tolerance > 0.)
          {
            touched.erase(std::remove_if(touched.begin(),
                                         touched.end(),
                                         [&](const unsigned int i) {
                                           return std::abs(column[i] *
                                                           inverse_root) <
                                                  drop_tolerance;
                                         }),
                          touched.end());
            std::sort(touched.begin(), touched.end());
          }
        for (const unsigned int i : touched)
          {
            rows.push_back(i);
            entries.push_back(column[i] * inverse_root);
          }
        if (!touched.empty())
          finished.insert(k, touched.front(), column_begin.back());
        column_begin.push_back(rows.size());
        inverse_pivots[k] = inverse_root;
      }
    return true;
  }



  UpperTriangle
  IncompleteCholesky::complement(
    const UpperTriangle              &last_rows,
    const std::vector<unsigned char> &is_fixed) const
  {
    const unsigned int n = last_rows.size(), first = size();
    ColumnsByRow       columns(first + n);
    for (unsigned int j = 0; j < first; ++j)
      {
        const auto end = rows.begin() + column_begin[j + 1];
        const auto entry =
          std::lower_bound(rows.begin() + column_begin[j], end, first);
        if (entry != end)
          columns.insert(j, *entry, entry - rows.begin());
      }
    UpperTriangle             result;
    std::vector<double>       row(n, 0.);
    std::vector<unsigned int> touched, last_row_with(n, n);
    for (unsigned int k = 0; k < n; ++k)
      {
        touched.clear();
        const auto add = [&](const unsigned int i, const double value) {
          if (i != k && (is_fixed[i] || is_fixed[k]))
            return;
          if (last_row_with[i] != k)
            {
              last_row_with[i] = k;
              row[i]           = 0.;
              touched.push_back(i);
            }
          row[i] += value;
        };
        for (std::size_t e = last_rows.row_begin[k];
             e < last_rows.row_begin[k + 1];
             ++e)
          add(last_rows.columns[e], last_rows.values[e]);
        columns.take(first + k,
                     [&](const unsigned int j, const std::size_t entry) {
                       // L_kj D_j
                       const double factor =
                         entries[entry] * largest_diagonal / inverse_pivots[j];
                       const std::size_t end = column_begin[j + 1];
                       if (!is_fixed[k])
                         for (std::size_t e = entry; e < end; ++e)
                           add(rows[e] - first, -factor * entries[e]);
                       if (entry + 1 < end)
                         columns.insert(j, rows[entry + 1], entry + 1);
                     });
        // The shift and the smallest pivot of rows that are eliminated here.
        const double diagonal = last_rows.diagonal(k);
        row[k]                = is_fixed[k] ? largest_diagonal
                                            : std::max(row[k] + used_shift * diagonal,
                                        smallest_pivot * diagonal);
        std::sort(touched.begin(), touched.end());
        for (const unsigned int i : touched)
          {
            result.columns.push_back(i);
            result.values.push_back(row[i]);
          }
        result.row_begin.push_back(result.columns.size());
      }
    return result;
  }



  void
  IncompleteCholesky::undo_scaling(const std::vector<double> &scaling)
  {
    // With A = S M S: 1 + L = S^-1 C diag(C)^-1 S, D = S^-2 diag(C)^2.
    for (unsigned int k = 0; k < size(); ++k)
      {
        const double scale = inverse_pivots[k] * scaling[k];
        for (std::size_t e = column_begin[k]; e < column_begin[k + 1]; ++e)
          entries[e] *= scale / scaling[rows[e]];
        inverse_pivots[k] = largest_diagonal * scale * scale;
      }
  }



  double
  IncompleteCholesky::largest_eigenvalue(const UpperTriangle &matrix) const
  {
    constexpr unsigned int max_products = 5;
    using Vector                        = std::vector<double>;
    const unsigned int n                = size();

    const auto multiply = [&](Vector &y, const Vector &x) {
      y.assign(n, 0.);
      for (unsigned int i = 0; i < n; ++i)
        {
          const std::size_t begin = matrix.row_begin[i];
          double            sum   = matrix.values[begin] * x[i];
          for (std::size_t e = begin + 1; e < matrix.row_begin[i + 1]; ++e)
            {
              const unsigned int j = matrix.columns[e];
              sum += matrix.values[e] * x[j];
              y[j] += matrix.values[e] * x[i];
            }
          y[i] += sum;
        }
    };
    const auto precondition = [&](Vector &y, const Vector &x) {
      y = x;
      solve(y.data(), 1);
    };

    // Random signs, the same in each run.
    Vector        start(n, 0.);
    std::uint64_t bits = 1;
    for (unsigned int i = 0; i < n; ++i)
      {
        bits     = bits * 6364136223846793005u + 1442695040888963407u;
        start[i] = std::copysign(std::sqrt(matrix.diagonal(i)),
                                 static_cast<std::int64_t>(bits));
      }
    return greville::largest_eigenvalue(
             multiply, precondition, start, 0.1, max_products, MPI_COMM_SELF)
      .value;
  }



  void
  IncompleteCholesky::solve(double *x, const unsigned int width) const
  {
    const std::size_t n       = std::size_t(size()) * width;
    double            largest = 0.;
    for (std::size_t k = 0; k < n; ++k)
      largest = std::max(largest, std::abs(x[k]));
    if (!(largest > 0.))
      return;
    single.resize(n);
    const double scale = 1. / largest;
    for (std::size_t k = 0; k < n; ++k)
      single[k] = scale * x[k];
    solve(single.data(), width);
    for (std::size_t k = 0; k < n; ++k)
      x[k] = largest / largest_diagonal * single[k];
  }



  namespace
  {
    /// Interleaved columns by rows.
    template <int width>
    struct ColumnsOfRows
    {
      using Columns = FixedSimd<float, width>;

      float *x;

      Columns
      operator[](const std::size_t row) const
      {
        return load<Columns>(x + row * width);
      }

      void
      set(const std::size_t row, const Columns &values) const
      {
        store(values, x + row * width);
      }
    };
  } // namespace



  void
  IncompleteCholesky::eliminate(float *x, const unsigned int width) const
  {
    with_width(width, [&](const auto w) {
      const ColumnsOfRows<decltype(w)::value> at{x};
      const unsigned int                     *r = rows.data();
      const float                            *l = entries.data();
      for (std::size_t k = 0; k < size(); ++k)
        {
          const auto value = at[k];
          for (std::size_t e = column_begin[k]; e < column_begin[k + 1]; ++e)
            at.set(r[e], at[r[e]] - l[e] * value);
        }
    });
  }



  void
  IncompleteCholesky::substitute(float *x, const unsigned int width) const
  {
    with_width(width, [&](const auto w) {
      using Columns = typename ColumnsOfRows<decltype(w)::value>::Columns;
      const ColumnsOfRows<decltype(w)::value> at{x};
      for (std::size_t k = size(); k-- > 0;)
        {
          // Use two sums: the first entries wait for the preceding rows.
          Columns           sum = inverse_pivots[k] * at[k], other_sum = 0.f;
          std::size_t       e   = column_begin[k];
          const std::size_t end = column_begin[k + 1];
          for (; e + 1 < end; e += 2)
            {
              sum -= entries[e] * at[rows[e]];
              other_sum -= entries[e + 1] * at[rows[e + 1]];
            }
          if (e < end)
            sum -= entries[e] * at[rows[e]];
          at.set(k, sum + other_sum);
        }
    });
  }
} // namespace greville

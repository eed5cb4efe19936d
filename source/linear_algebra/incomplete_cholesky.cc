// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>

#include <greville/base/largest_eigenvalue.h>
#include <greville/base/simd.h>
#include <greville/base/with_width.h>
#include <greville/linear_algebra/incomplete_cholesky.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Smaller pivots of the scaled matrix are round-off, or the result of
    // dropped fill. If they are far below zero, the factors grow without
    // bounds.
    constexpr double smallest_pivot = 3e-5;
    constexpr double lowest_pivot   = -0.1;

    // The smallest shift, and the largest shift used to bound the eigenvalues
    // of the preconditioned matrix: larger shifts cost more iterations than
    // they save.
    constexpr double first_shift       = 1e-3;
    constexpr double largest_remedy    = 4e-3;
    constexpr double largest_tolerable = 2.;
  } // namespace



  void
  IncompleteCholesky::factorize(const LowerTriangle &matrix, const double shift)
  {
    LowerTriangle none;
    factorize(matrix, shift, matrix.size(), none);
  }



  void
  IncompleteCholesky::factorize(const LowerTriangle &matrix,
                                const double         shift,
                                const unsigned int   n_eliminated,
                                LowerTriangle       &schur)
  {
    const unsigned int  n = matrix.size();
    std::vector<double> scaling(n);
    largest_diagonal = 0.;
    for (unsigned int i = 0; i < n; ++i)
      {
        const double diagonal = matrix.values[matrix.row_begin[i + 1] - 1];
        AssertThrow(i >= n_eliminated ||
                      (diagonal > 0. && std::isfinite(diagonal)),
                    ExcMessage("IC(0) needs a positive diagonal, but entry " +
                               std::to_string(i) + " is " +
                               std::to_string(diagonal) + "."));
        scaling[i]       = diagonal > 0. ? 1. / std::sqrt(diagonal) : 1.;
        largest_diagonal = std::max(largest_diagonal, diagonal);
      }
    if (!(largest_diagonal > 0.))
      largest_diagonal = 1.;

    // The strictly lower rows, in eliminated columns.
    row_begin.resize(n + 1);
    row_begin[0] = 0;
    columns.clear();
    columns.reserve(matrix.columns.size());
    for (unsigned int i = 0; i < n; ++i)
      {
        const auto begin = matrix.columns.begin() + matrix.row_begin[i];
        auto       end   = matrix.columns.begin() + matrix.row_begin[i + 1] - 1;
        if (i > n_eliminated)
          end = std::lower_bound(begin, end, n_eliminated);
        columns.insert(columns.end(), begin, end);
        row_begin[i + 1] = columns.size();
      }
    entries.resize(columns.size());
    inverse_pivots.resize(n_eliminated);
    work.assign(n, 0.);

    used_shift = shift;
    while (!try_shift(matrix, scaling, used_shift, schur) ||
           (used_shift < largest_remedy &&
            largest_eigenvalue(matrix) > largest_tolerable))
      {
        used_shift = std::max(2. * used_shift, first_shift);
        AssertThrow(used_shift < 10.,
                    ExcMessage("IC(0) fails with all shifts: the matrix is not "
                               "positive definite."));
      }
  }



  bool
  IncompleteCholesky::try_shift(const LowerTriangle       &matrix,
                                const std::vector<double> &scaling,
                                const double               shift,
                                LowerTriangle             &schur)
  {
    // Factorize row by row, for the scaled matrix A: with u_j = L_ij D_j,
    //   u_k = A_ik - sum_(j<k) u_j L_kj,   D_i = A_ii - sum_j u_j L_ij.
    const unsigned int n_eliminated = inverse_pivots.size();
    n_raised_pivots                 = 0;
    schur                           = LowerTriangle();
    std::vector<double> pivots(n_eliminated);
    for (unsigned int i = 0; i < matrix.size(); ++i)
      {
        const std::size_t  begin = row_begin[i], end = row_begin[i + 1];
        const double      *row   = matrix.values.data() + matrix.row_begin[i];
        const unsigned int first = begin < end ? columns[begin] : 0;
        const auto reduced = [&](const double value, const unsigned int k) {
          double u[4] = {value * scaling[i] * scaling[k], 0., 0., 0.};
          const std::size_t begin_k = row_begin[k];
          std::size_t       f       = row_begin[k + 1];
          // Four independent sums.
          for (; f >= begin_k + 4 && columns[f - 4] >= first; f -= 4)
            for (unsigned int lane = 0; lane < 4; ++lane)
              u[lane] -= work[columns[f - 1 - lane]] * entries[f - 1 - lane];
          for (; f > begin_k && columns[f - 1] >= first; --f)
            u[0] -= work[columns[f - 1]] * entries[f - 1];
          return (u[0] + u[1]) + (u[2] + u[3]);
        };
        double sum = 0.;
        for (std::size_t e = begin; e < end; ++e)
          {
            const unsigned int k = columns[e];
            const double       u = reduced(row[e - begin], k);
            const double       l = u / pivots[k];
            work[k]              = u;
            entries[e]           = l;
            sum += u * l;
          }
        if (i >= n_eliminated)
          {
            // The Schur complement of the other rows.
            for (std::size_t e = matrix.row_begin[i] + (end - begin);
                 e + 1 < matrix.row_begin[i + 1];
                 ++e)
              {
                const unsigned int k = matrix.columns[e];
                schur.columns.push_back(k - n_eliminated);
                schur.values.push_back(reduced(matrix.values[e], k) /
                                       (scaling[i] * scaling[k]));
              }
            schur.columns.push_back(i - n_eliminated);
            schur.values.push_back(matrix.values[matrix.row_begin[i + 1] - 1] -
                                   sum / (scaling[i] * scaling[i]));
            schur.row_begin.push_back(schur.columns.size());
          }
        for (std::size_t e = begin; e < end; ++e)
          work[columns[e]] = 0.;
        if (i >= n_eliminated)
          continue;
        double pivot = 1. + shift - sum;
        if (!(pivot > lowest_pivot))
          return false;
        if (pivot < smallest_pivot)
          {
            pivot = smallest_pivot;
            ++n_raised_pivots;
          }
        pivots[i] = pivot;
      }

    // Undo the scaling: L <- S^-1 L S, D <- S^-1 D S^-1.
    for (unsigned int i = 0; i < matrix.size(); ++i)
      {
        for (std::size_t e = row_begin[i]; e < row_begin[i + 1]; ++e)
          entries[e] *= scaling[columns[e]] / scaling[i];
        if (i < n_eliminated)
          inverse_pivots[i] =
            largest_diagonal * scaling[i] * scaling[i] / pivots[i];
      }
    return true;
  }



  double
  IncompleteCholesky::largest_eigenvalue(const LowerTriangle &matrix) const
  {
    constexpr unsigned int max_products = 5;
    using Vector                        = std::vector<double>;
    const unsigned int n                = size();
    const unsigned int n_eliminated     = inverse_pivots.size();

    const auto multiply = [&](Vector &y, const Vector &x) {
      y.assign(n, 0.);
      for (unsigned int i = 0; i < n_eliminated; ++i)
        {
          const std::size_t end = matrix.row_begin[i + 1] - 1;
          double            sum = matrix.values[end] * x[i];
          for (std::size_t e = matrix.row_begin[i]; e < end; ++e)
            {
              const unsigned int j = matrix.columns[e];
              sum += matrix.values[e] * x[j];
              y[j] += matrix.values[e] * x[i];
            }
          y[i] += sum;
        }
    };
    const auto precondition = [&](Vector &y, const Vector &x) {
      y.assign(n, 0.);
      double largest = 0.;
      for (const double value : x)
        largest = std::max(largest, std::abs(value));
      if (!(largest > 0.))
        return;
      single.assign(n, 0.f);
      for (unsigned int i = 0; i < n_eliminated; ++i)
        single[i] = x[i] / largest;
      forward(single.data(), 1);
      std::fill(single.begin() + n_eliminated, single.end(), 0.f);
      backward(single.data(), 1);
      for (unsigned int i = 0; i < n_eliminated; ++i)
        y[i] = largest / largest_diagonal * single[i];
    };

    // Random signs, the same in each run.
    Vector        start(n, 0.);
    std::uint64_t bits = 1;
    for (unsigned int i = 0; i < n_eliminated; ++i)
      {
        bits = bits * 6364136223846793005u + 1442695040888963407u;
        start[i] =
          std::copysign(std::sqrt(matrix.values[matrix.row_begin[i + 1] - 1]),
                        static_cast<std::int64_t>(bits));
      }
    return greville::largest_eigenvalue(
             multiply, precondition, start, 0.1, max_products, MPI_COMM_SELF)
      .value;
  }



  void
  IncompleteCholesky::solve(double                *x,
                            const unsigned int     width,
                            const ConstrainedRows &constrained) const
  {
    // Solve in single precision, with numbers of order 1.
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
    forward(single.data(), width, constrained);
    backward(single.data(), width, constrained);
    for (std::size_t k = 0; k < n; ++k)
      x[k] = largest / largest_diagonal * single[k];
  }



  namespace
  {
    template <int width>
    using Columns = FixedSimd<float, width>;

    template <int width>
    Columns<width>
    at(const float *x, const std::size_t i)
    {
      return load<Columns<width>>(x + i * width);
    }

    template <int width>
    void
    put(float *x, const std::size_t i, const Columns<width> &value)
    {
      store(value, x + i * width);
    }

    /// Return one for the vectors that contain the row, zero for the others.
    template <int width>
    Columns<width>
    mask(const unsigned int bits, const unsigned int n_components)
    {
      return Columns<width>([&](const unsigned int c) {
        return (bits >> (c % n_components)) & 1 ? 0.f : 1.f;
      });
    }
  } // namespace



  void
  IncompleteCholesky::forward(float                 *x,
                              const unsigned int     width,
                              const ConstrainedRows &constrained) const
  {
    with_width(width, [&](const auto w) {
      forward_interleaved<decltype(w)::value>(x, constrained);
    });
  }



  void
  IncompleteCholesky::backward(float                 *x,
                               const unsigned int     width,
                               const ConstrainedRows &constrained) const
  {
    with_width(width, [&](const auto w) {
      backward_interleaved<decltype(w)::value>(x, constrained);
    });
  }



  template <int width>
  void
  IncompleteCholesky::forward_interleaved(
    float *x, const ConstrainedRows &constrained) const
  {
    const unsigned int *c      = columns.data();
    const float        *l      = entries.data();
    const auto          reduce = [&](const std::size_t i) {
      // Two sums, since the last entries of a row wait for the rows just
      // before.
      Columns<width>    sum = at<width>(x, i), other_sum = 0.f;
      std::size_t       e   = row_begin[i];
      const std::size_t end = row_begin[i + 1];
      for (; e + 1 < end; e += 2)
        {
          sum -= l[e] * at<width>(x, c[e]);
          other_sum -= l[e + 1] * at<width>(x, c[e + 1]);
        }
      if (e < end)
        sum -= l[e] * at<width>(x, c[e]);
      return sum + other_sum;
    };
    std::size_t i = 0;
    for (const auto &row : constrained.rows)
      {
        for (; i < row.first; ++i)
          put<width>(x, i, reduce(i));
        put<width>(
          x, i, mask<width>(row.second, constrained.n_components) * reduce(i));
        ++i;
      }
    for (; i < size(); ++i)
      put<width>(x, i, reduce(i));
  }



  template <int width>
  void
  IncompleteCholesky::backward_interleaved(
    float *x, const ConstrainedRows &constrained) const
  {
    const unsigned int *c          = columns.data();
    const float        *l          = entries.data();
    const auto          substitute = [&](const std::size_t     i,
                                const Columns<width> &value) {
      for (std::size_t e = row_begin[i]; e < row_begin[i + 1]; ++e)
        put<width>(x, c[e], at<width>(x, c[e]) - l[e] * value);
    };
    for (std::size_t i = 0; i < inverse_pivots.size(); ++i)
      put<width>(x, i, at<width>(x, i) * inverse_pivots[i]);
    std::size_t i = size();
    for (auto row = constrained.rows.rbegin(); row != constrained.rows.rend();
         ++row)
      {
        while (--i > row->first)
          substitute(i, at<width>(x, i));
        const Columns<width> value =
          mask<width>(row->second, constrained.n_components) * at<width>(x, i);
        put<width>(x, i, value);
        substitute(i, value);
      }
    while (i-- > 0)
      substitute(i, at<width>(x, i));
  }



} // namespace greville

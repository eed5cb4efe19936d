#include <deal.II/base/exceptions.h>

#include <greville/multigrid/incomplete_cholesky.h>

#include <cmath>
#include <experimental/simd>
#include <string>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Smaller pivots of the scaled matrix are round-off, or what IC(0) leaves
    // of a row whose fill it drops. Far below zero the factors grow without
    // bounds.
    constexpr double smallest_pivot = 3e-5;
    constexpr double lowest_pivot   = -0.1;
  } // namespace



  void
  IncompleteCholesky::factorize(const LowerTriangle &matrix, const double shift)
  {
    const unsigned int  n = matrix.size();
    std::vector<double> scaling(n);
    for (unsigned int i = 0; i < n; ++i)
      {
        const double diagonal = matrix.values[matrix.row_begin[i + 1] - 1];
        AssertThrow(diagonal > 0. && std::isfinite(diagonal),
                    ExcMessage("IC(0) needs a positive diagonal, but entry " +
                               std::to_string(i) + " is " +
                               std::to_string(diagonal) + "."));
        scaling[i] = 1. / std::sqrt(diagonal);
        unit       = i == 0 ? diagonal : std::max(unit, diagonal);
      }

    // Strictly lower rows.
    row_begin.resize(n + 1);
    row_begin[0] = 0;
    columns.clear();
    columns.reserve(matrix.columns.size());
    for (unsigned int i = 0; i < n; ++i)
      {
        columns.insert(columns.end(),
                       matrix.columns.begin() + matrix.row_begin[i],
                       matrix.columns.begin() + matrix.row_begin[i + 1] - 1);
        row_begin[i + 1] = columns.size();
      }
    entries.resize(columns.size());
    inverse_pivots.resize(n);
    work.assign(n, 0.);

    used_shift = shift;
    while (!try_shift(matrix, scaling, used_shift))
      {
        used_shift = std::max(2. * used_shift, 1e-3);
        AssertThrow(used_shift < 10.,
                    ExcMessage("IC(0) fails with all shifts: the matrix is not "
                               "positive definite."));
      }
  }



  bool
  IncompleteCholesky::try_shift(const LowerTriangle       &matrix,
                                const std::vector<double> &scaling,
                                const double               shift)
  {
    // Row by row, on the scaled matrix A: with u_j = L_ij D_j,
    //   u_k = A_ik - sum_(j<k) u_j L_kj,   D_i = A_ii - sum_j u_j L_ij.
    n_raised_pivots = 0;
    std::vector<double> pivots(matrix.size());
    for (unsigned int i = 0; i < matrix.size(); ++i)
      {
        const std::size_t  begin = row_begin[i], end = row_begin[i + 1];
        const double      *row   = matrix.values.data() + matrix.row_begin[i];
        double             pivot = 1. + shift;
        const unsigned int first = begin < end ? columns[begin] : 0;
        for (std::size_t e = begin; e < end; ++e)
          {
            const unsigned int k = columns[e];
            double             u = row[e - begin] * scaling[i] * scaling[k];
            for (std::size_t f = row_begin[k + 1]; f > row_begin[k];)
              {
                --f;
                if (columns[f] < first)
                  break;
                u -= work[columns[f]] * entries[f];
              }
            work[k]        = u;
            const double l = u / pivots[k];
            pivot -= u * l;
            entries[e] = l;
          }
        for (std::size_t e = begin; e < end; ++e)
          work[columns[e]] = 0.;
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
        inverse_pivots[i] = unit * scaling[i] * scaling[i] / pivots[i];
      }
    return true;
  }



  void
  IncompleteCholesky::solve(double *x, const unsigned int width) const
  {
    switch (width)
      {
        case 1:
          return solve_interleaved<1>(x);
        case 2:
          return solve_interleaved<2>(x);
        case 4:
          return solve_interleaved<4>(x);
        case 8:
          return solve_interleaved<8>(x);
        default:
          Assert(false, ExcInternalError());
      }
  }



  template <int width>
  void
  IncompleteCholesky::solve_interleaved(double *values) const
  {
    namespace simd = std::experimental;
    using Vector   = simd::simd<float, simd::simd_abi::deduce_t<float, width>>;

    // In single precision, of numbers of the size 1.
    const std::size_t n       = size();
    double            largest = 0.;
    for (std::size_t k = 0; k < n * width; ++k)
      largest = std::max(largest, std::abs(values[k]));
    if (!(largest > 0.))
      return;
    single.resize(n * width);
    const double scale = 1. / largest;
    for (std::size_t k = 0; k < n * width; ++k)
      single[k] = scale * values[k];

    float     *x  = single.data();
    const auto at = [x](const unsigned int i) {
      return Vector(x + std::size_t(i) * width, simd::element_aligned);
    };
    const auto put = [x](const unsigned int i, const Vector &value) {
      value.copy_to(x + std::size_t(i) * width, simd::element_aligned);
    };
    const unsigned int *c = columns.data();
    const float        *l = entries.data();
    for (std::size_t i = 0; i < n; ++i)
      {
        // Two sums: the last entries of a row wait for the rows just before.
        Vector            sum = at(i), other_sum = 0.f;
        std::size_t       e   = row_begin[i];
        const std::size_t end = row_begin[i + 1];
        for (; e + 1 < end; e += 2)
          {
            sum -= l[e] * at(c[e]);
            other_sum -= l[e + 1] * at(c[e + 1]);
          }
        if (e < end)
          sum -= l[e] * at(c[e]);
        put(i, sum + other_sum);
      }
    for (std::size_t i = 0; i < n; ++i)
      put(i, at(i) * inverse_pivots[i]);
    for (std::size_t i = n; i-- > 0;)
      {
        const Vector value = at(i);
        for (std::size_t e = row_begin[i]; e < row_begin[i + 1]; ++e)
          put(c[e], at(c[e]) - l[e] * value);
      }
    for (std::size_t k = 0; k < n * width; ++k)
      values[k] = largest / unit * single[k];
  }



  std::size_t
  IncompleteCholesky::memory_consumption() const
  {
    return entries.size() * sizeof(float) +
           columns.size() * sizeof(unsigned int) +
           inverse_pivots.size() * 2 * sizeof(double) +
           row_begin.size() * sizeof(std::size_t);
  }
} // namespace greville

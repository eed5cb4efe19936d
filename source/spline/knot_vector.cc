// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/spline/knot_vector.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  KnotVector::KnotVector(const unsigned int         degree,
                         const std::vector<double> &k)
    : p(degree)
    , t(k)
  {
    Require(p >= 1, "A knot vector needs an order of 1 or more.");
    Require(t.size() >= 2 * (p + 1) && std::is_sorted(t.begin(), t.end()),
            "The knots of order " + std::to_string(p) +
              " have to be at least " + std::to_string(2 * (p + 1)) +
              " numbers that do not decrease.");
    Require(t[p] == t.front() && t[t.size() - p - 1] == t.back(),
            "A knot vector is open if its first and its last knot are repeated "
            "order + 1 times.");
    for (unsigned int i = 1; i + p + 1 < t.size(); ++i)
      Require(t[i] < t[i + p] || i + p >= t.size() - 1,
              "An inner knot is repeated more than " + std::to_string(p) +
                " times.");

    for (unsigned int i = p; i + p + 1 < t.size(); ++i)
      if (t[i] < t[i + 1])
        spans.push_back(i);
    Require(!spans.empty(), "The knot vector has no length.");
  }



  KnotVector
  KnotVector::open(const unsigned int         degree,
                   const std::vector<double> &breakpoints)
  {
    Require(breakpoints.size() > 1, "A knot vector needs an element.");
    std::vector<double> knots(degree, breakpoints.front());
    knots.insert(knots.end(), breakpoints.begin(), breakpoints.end());
    knots.insert(knots.end(), degree, breakpoints.back());
    return KnotVector(degree, knots);
  }



  KnotVector
  KnotVector::open_uniform(const unsigned int degree,
                           const unsigned int n_elements,
                           const double       lower,
                           const double       upper)
  {
    Require(n_elements > 0 && lower < upper,
            "A knot vector needs at least one element, and a lower end below "
            "its upper end.");
    std::vector<double> breakpoints;
    for (unsigned int i = 0; i <= n_elements; ++i)
      breakpoints.push_back(
        i == n_elements ? upper : lower + (upper - lower) * i / n_elements);
    return open(degree, breakpoints);
  }



  KnotVector
  KnotVector::of_levels(const unsigned int               degree,
                        const std::vector<double>       &edges,
                        const std::vector<unsigned int> &begin,
                        const std::vector<unsigned int> &size)
  {
    KnotVector result;
    result.p = degree;
    result.t.assign(edges.size() + 2 * degree, edges.back());
    for (unsigned int l = 0; l < begin.size(); ++l)
      {
        const auto first = edges.begin() + begin[l];
        const auto knots = result.t.begin() + begin[l];
        std::fill_n(knots, degree, *first);
        std::copy_n(first, size[l] + 1, knots + degree);
        std::fill_n(knots + degree + size[l] + 1, degree, first[size[l]]);
      }
    for (unsigned int e = 0; e + 1 < edges.size(); ++e)
      result.spans.push_back(degree + e);
    return result;
  }



  KnotVector
  KnotVector::periodic_uniform(const unsigned int degree,
                               const unsigned int n_elements,
                               const double       lower,
                               const double       upper)
  {
    Require(degree >= 1 && n_elements > 0 && lower < upper,
            "A periodic knot vector needs an order of 1 or more, at least one "
            "element, and a lower end below its upper end.");
    KnotVector result;
    result.p       = degree;
    const double h = (upper - lower) / n_elements;
    const int    n = n_elements;
    for (int i = -int(degree); i <= n + int(degree); ++i)
      result.t.push_back(i == n ? upper : lower + h * i);
    for (unsigned int e = 0; e < n_elements; ++e)
      result.spans.push_back(degree + e);
    return result;
  }



  unsigned int
  KnotVector::find_element(const double x) const
  {
    const auto next =
      std::upper_bound(spans.begin(),
                       spans.end(),
                       x,
                       [this](const double y, const unsigned int span) {
                         return y < t[span];
                       });
    return next == spans.begin() ? 0 : next - spans.begin() - 1;
  }



  void
  KnotVector::evaluate(const unsigned int       element,
                       const double             x,
                       const unsigned int       derivative,
                       const ArrayView<double> &values) const
  {
    AssertThrow(derivative < 3, ExcIndexRange(derivative, 0, 3));
    AssertThrow(values.size() == p + 1,
                ExcDimensionMismatch(values.size(), p + 1));
    const unsigned int span = spans[element];

    if (derivative > p)
      {
        std::fill(values.begin(), values.end(), 0.);
        return;
      }

    // Functions of order p - derivative: values[p - order + a] belongs to
    // function span - order + a; earlier entries are zero on the element.
    std::fill(values.begin(), values.end(), 0.);
    values[p] = 1.;
    for (unsigned int order = 1; order <= p; ++order)
      for (unsigned int a = p - order; a <= p; ++a)
        {
          const unsigned int i     = span - p + a;
          const double       own   = values[a];
          const double       next  = (a < p ? values[a + 1] : 0.);
          const double       left  = t[i + order] - t[i];
          const double       right = t[i + order + 1] - t[i + 1];
          if (order + derivative <= p)
            values[a] =
              (left > 0 ? (x - t[i]) / left * own : 0.) +
              (right > 0 ? (t[i + order + 1] - x) / right * next : 0.);
          else
            values[a] = order * ((left > 0 ? own / left : 0.) -
                                 (right > 0 ? next / right : 0.));
        }
  }



  void
  KnotVector::blossom(const unsigned int             element,
                      const ArrayView<const double> &arguments,
                      const ArrayView<double>       &weights) const
  {
    AssertThrow(arguments.size() == p,
                ExcDimensionMismatch(arguments.size(), p));
    AssertThrow(weights.size() == p + 1,
                ExcDimensionMismatch(weights.size(), p + 1));
    const unsigned int span = spans[element];

    // The algorithm of de Boor with another argument in every step, run
    // backwards on the weights: the weight of the single point of the last step
    // is distributed to the p + 1 coefficients of the first step.
    std::fill(weights.begin(), weights.end(), 0.);
    weights[p] = 1.;
    for (unsigned int step = p; step >= 1; --step)
      for (unsigned int a = step; a <= p; ++a)
        {
          const unsigned int i = span - p + a;
          const double       alpha =
            (arguments[step - 1] - t[i]) / (t[i + p + 1 - step] - t[i]);
          weights[a - 1] += (1. - alpha) * weights[a];
          weights[a] *= alpha;
        }
  }



  FullMatrix<double>
  KnotVector::extraction_matrix(const unsigned int element) const
  {
    FullMatrix<double>  matrix(p + 1, p + 1);
    std::vector<double> arguments(p), weights(p + 1);
    for (unsigned int b = 0; b <= p; ++b)
      {
        for (unsigned int k = 0; k < p; ++k)
          arguments[k] =
            (k < p - b ? element_lower(element) : element_upper(element));
        blossom(element,
                make_array_view(
                  const_cast<const std::vector<double> &>(arguments)),
                make_array_view(weights));
        for (unsigned int a = 0; a <= p; ++a)
          matrix(a, b) = weights[a];
      }
    return matrix;
  }



  BandedMatrix
  cross_matrix(const KnotVector &rows, const KnotVector &columns)
  {
    AssertThrow(rows.n_elements() == columns.n_elements(),
                ExcDimensionMismatch(rows.n_elements(), columns.n_elements()));
    const unsigned int n_rows = rows.degree() + 1,
                       n_cols = columns.degree() + 1;

    BandedMatrix matrix;
    matrix.n_rows    = rows.n_functions();
    matrix.n_columns = columns.n_functions();

    // The columns of a row: the functions of the elements in its support.
    matrix.first_column.assign(matrix.n_rows, matrix.n_columns);
    for (unsigned int e = 0; e < rows.n_elements(); ++e)
      for (unsigned int a = 0; a < n_rows; ++a)
        {
          const unsigned int first = columns.first_function(e);
          unsigned int &begin = matrix.first_column[rows.first_function(e) + a];
          begin               = std::min(begin, first);
          matrix.width        = std::max(matrix.width, first + n_cols - begin);
        }
    matrix.values.assign(std::size_t(matrix.n_rows) * matrix.width, 0.);

    const QGauss<1>     quadrature((n_rows + n_cols) / 2);
    std::vector<double> row_values(n_rows), column_values(n_cols);
    for (unsigned int e = 0; e < rows.n_elements(); ++e)
      for (unsigned int q = 0; q < quadrature.size(); ++q)
        {
          const double lower = rows.element_lower(e);
          const double h     = rows.element_upper(e) - lower;
          const double x     = lower + h * quadrature.point(q)(0);
          rows.evaluate(e, x, 0, make_array_view(row_values));
          columns.evaluate(e, x, 0, make_array_view(column_values));
          for (unsigned int a = 0; a < n_rows; ++a)
            for (unsigned int b = 0; b < n_cols; ++b)
              {
                const unsigned int i = rows.first_function(e) + a;
                const unsigned int j = columns.first_function(e) + b;
                matrix.values[i * matrix.width + j - matrix.first_column[i]] +=
                  h * quadrature.weight(q) * row_values[a] * column_values[b];
              }
        }
    return matrix;
  }
} // namespace greville

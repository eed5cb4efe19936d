// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/array_view.h>
#include <deal.II/lac/full_matrix.h>

#include <vector>

namespace greville
{
  /**
   * Univariate B-splines of order p (polynomial degree p) on an open knot
   * vector @f$ t_0 \le \dots \le t_{n+p} @f$, whose first and last knots are
   * repeated p + 1 times. The n basis functions follow from the recursion of
   * Cox and de Boor,
   * @f{align*}{
   *   N_{i,0}(x) &= 1 \text{ for } t_i \le x < t_{i+1}, \quad
   *                 0 \text{ otherwise}, \\
   *   N_{i,p}(x) &= \frac{x - t_i}{t_{i+p} - t_i} N_{i,p-1}(x)
   *               + \frac{t_{i+p+1} - x}{t_{i+p+1} - t_{i+1}} N_{i+1,p-1}(x)
   * @f}
   * (@ref Piegl1997 "Piegl and Tiller, 1997", chapter 2). An *element* is a
   * knot span of positive length, on which p + 1 functions do not vanish.
   *
   * Lengths carry the unit of the knots.
   */
  class KnotVector
  {
  public:
    KnotVector() = default;

    /// A general open knot vector: not decreasing, the first and the last knot
    /// @p degree + 1 times, inner knots at most @p degree times. Throws
    /// dealii::ExcMessage if @p knots is not of this kind.
    KnotVector(const unsigned int degree, const std::vector<double> &knots);

    /// Return the open knot vector whose elements lie between the
    /// @p breakpoints, which increase.
    static KnotVector
    open(const unsigned int degree, const std::vector<double> &breakpoints);

    /// Return the open uniform knot vector with @p n_elements elements of equal
    /// length on [@p lower, @p upper].
    static KnotVector
    open_uniform(const unsigned int degree,
                 const unsigned int n_elements,
                 const double       lower = 0.,
                 const double       upper = 1.);

    /// Return open knot vectors one behind the other, as CellHierarchy places
    /// the edges of its levels: vector l has the breakpoints
    /// @p edges[@p begin[l]], ..., of @p size[l] elements. Element e is the
    /// cell e, whose first function is e. Elements and functions between two
    /// vectors have no meaning.
    static KnotVector
    of_levels(const unsigned int               degree,
              const std::vector<double>       &edges,
              const std::vector<unsigned int> &begin,
              const std::vector<unsigned int> &size);

    /// Return a knot vector with the same elements and equidistant knots that
    /// continue beyond both ends. Function n_elements + k is function k shifted
    /// by one period: all functions are translates of one another, and a
    /// periodic spline has the same coefficient for both.
    static KnotVector
    periodic_uniform(const unsigned int degree,
                     const unsigned int n_elements,
                     const double       lower = 0.,
                     const double       upper = 1.);

    unsigned int
    degree() const
    {
      return p;
    }

    unsigned int
    n_functions() const
    {
      return t.size() - p - 1;
    }

    unsigned int
    n_elements() const
    {
      return spans.size();
    }

    const std::vector<double> &
    knots() const
    {
      return t;
    }

    /// Return the end points of an element.
    double
    element_lower(const unsigned int element) const
    {
      return t[spans[element]];
    }

    double
    element_upper(const unsigned int element) const
    {
      return t[spans[element] + 1];
    }

    /// Return the element that contains x; the last one for @f$ x = t_{n+p}
    /// @f$, and the nearest one for points outside.
    unsigned int
    find_element(const double x) const;

    /// Return the first of the p + 1 functions that do not vanish on
    /// @p element.
    unsigned int
    first_function(const unsigned int element) const
    {
      return spans[element] - p;
    }

    /// Return the Greville abscissa (t_(i+1) + ... + t_(i+p)) / p of function
    /// @p i.
    double
    greville_abscissa(const unsigned int i) const
    {
      AssertThrow(i < n_functions(),
                  dealii::ExcIndexRange(i, 0, n_functions()));
      double sum = 0;
      for (unsigned int k = 1; k <= p; ++k)
        sum += t[i + k];
      return sum / p;
    }

    /// Evaluate the derivative of order @p derivative (0, 1 or 2) of the p + 1
    /// functions of @p element at @p x. Outside the element, the functions
    /// continue as polynomials. @p values has p + 1 entries.
    void
    evaluate(const unsigned int               element,
             const double                     x,
             const unsigned int               derivative,
             const dealii::ArrayView<double> &values) const;

    /**
     * Compute the weights of the blossom (polar form) of the polynomial that
     * represents a spline with coefficients c on @p element:
     * @f[ b(u_1, \dots, u_p) = \sum_{a=0}^p w_a \, c_{f + a} @f]
     * with the first_function() f of the element. By the dual functionals of de
     * Boor and Fix, b at the inner knots @f$ t_{i+1}, \dots, t_{i+p} @f$ is the
     * coefficient @f$ c_i @f$, for any function i. @p arguments has p entries,
     * @p weights p + 1.
     */
    void
    blossom(const unsigned int                     element,
            const dealii::ArrayView<const double> &arguments,
            const dealii::ArrayView<double>       &weights) const;

    /**
     * Return the (p+1) x (p+1) Bezier extraction matrix C of @p element, with
     * @f[ N_{f + a} = \sum_{b=0}^p C_{ab} B_b @f]
     * for the first_function() f and the Bernstein polynomials @f$ B_b @f$ of
     * the element (@ref Borden2011 "Borden et al., 2011"). Row a, column b is
     * the blossom of function a, with p - b arguments at the lower and b at the
     * upper end.
     */
    dealii::FullMatrix<double>
    extraction_matrix(const unsigned int element) const;

  private:
    unsigned int              p = 0;
    std::vector<double>       t;
    std::vector<unsigned int> spans; // t[spans[e]] < t[spans[e] + 1]
  };



  /// A matrix whose rows have their entries in one contiguous range of columns:
  /// entry (i, first_column[i] + k) is values[i * width + k].
  struct BandedMatrix
  {
    unsigned int              n_rows    = 0;
    unsigned int              n_columns = 0;
    unsigned int              width     = 0;
    std::vector<unsigned int> first_column;
    std::vector<double>       values;

    /// Return an entry; zero outside the band.
    double
    operator()(const unsigned int i, const unsigned int j) const
    {
      const unsigned int k = j - first_column[i];
      return (j >= first_column[i] && k < width) ? values[i * width + k] : 0.;
    }
  };

  /// Return the cross matrix @f$ \int N_i^\text{rows} N_j^\text{columns} \, dx
  /// @f$ of two knot vectors with the same elements, exact by Gauss quadrature.
  /// It is the mass matrix if both arguments are equal.
  BandedMatrix
  cross_matrix(const KnotVector &rows, const KnotVector &columns);
} // namespace greville

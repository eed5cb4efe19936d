// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_knot_vector_h
#define greville_spline_knot_vector_h

#include <deal.II/base/array_view.h>
#include <deal.II/lac/full_matrix.h>

#include <vector>

namespace greville
{
  /**
   * Univariate B-splines of order p (polynomial degree p) on an open knot
   * vector t_0 <= ... <= t_(n+p), whose first and last knots are repeated
   * p + 1 times. The n basis functions follow from the recursion of Cox and
   * de Boor,
   *   N_(i,0)(x) = 1 for t_i <= x < t_(i+1), 0 otherwise,
   *   N_(i,p)(x) = (x - t_i) / (t_(i+p) - t_i) N_(i,p-1)(x)
   *              + (t_(i+p+1) - x) / (t_(i+p+1) - t_(i+1)) N_(i+1,p-1)(x)
   * (L. Piegl and W. Tiller, The NURBS Book, chapter 2). An *element* is a
   * knot span of positive length; p + 1 functions live on each.
   *
   * Lengths carry the unit of the knots.
   */
  class KnotVector
  {
  public:
    KnotVector() = default;

    /**
     * A general open knot vector: not decreasing, the first and the last knot
     * @p degree + 1 times, inner knots at most @p degree times. Throws
     * dealii::ExcMessage where @p knots is none.
     */
    KnotVector(const unsigned int degree, const std::vector<double> &knots);

    /**
     * The open uniform knot vector with @p n_elements elements of equal length
     * on [@p lower, @p upper].
     */
    static KnotVector
    open_uniform(const unsigned int degree,
                 const unsigned int n_elements,
                 const double       lower = 0.,
                 const double       upper = 1.);

    /**
     * The same elements with equidistant knots that go on beyond both ends.
     * With these knots, function n_elements + k is function k one period
     * further on: all functions are alike, and a periodic spline has the same
     * coefficient for both.
     */
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

    /**
     * The end points of an element.
     */
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

    /**
     * The element that contains x; the last one for x = t_(n+p). Points outside
     * are counted to the nearest element.
     */
    unsigned int
    find_element(const double x) const;

    /**
     * The first of the p + 1 functions that do not vanish on @p element.
     */
    unsigned int
    first_function(const unsigned int element) const
    {
      return spans[element] - p;
    }

    /**
     * The Greville abscissa (t_(i+1) + ... + t_(i+p)) / p of function @p i.
     */
    double
    greville_abscissa(const unsigned int i) const
    {
      AssertIndexRange(i, n_functions());
      double sum = 0;
      for (unsigned int k = 1; k <= p; ++k)
        sum += t[i + k];
      return sum / p;
    }

    /**
     * Derivative of order @p derivative (0, 1 or 2) of the p + 1 functions of
     * @p element, continued as polynomials outside of it, at @p x. @p values
     * has p + 1 entries.
     */
    void
    evaluate(const unsigned int               element,
             const double                     x,
             const unsigned int               derivative,
             const dealii::ArrayView<double> &values) const;

    /**
     * Weights of the blossom (polar form) of the polynomial that a spline with
     * coefficients c is on @p element:
     *   b(u_1, ..., u_p) = sum_a weights[a] c_(first_function(element) + a).
     * By the dual functionals of de Boor and Fix, b at the inner knots
     * t_(i+1), ..., t_(i+p) is the coefficient c_i, for any function i.
     * @p arguments has p entries, @p weights p + 1.
     */
    void
    blossom(const unsigned int                     element,
            const dealii::ArrayView<const double> &arguments,
            const dealii::ArrayView<double>       &weights) const;

    /**
     * The (p+1) x (p+1) Bezier extraction matrix C of @p element, with
     *   N_(first_function + a) = sum_b C(a, b) B_b
     * for the Bernstein polynomials B_b of the element (M. Borden, M. Scott,
     * J. Evans, T. Hughes, Isogeometric finite element data structures based
     * on Bezier extraction of NURBS, 2011). Row a, column b is the blossom of
     * function a, with p - b arguments at the lower and b at the upper end.
     */
    dealii::FullMatrix<double>
    extraction_matrix(const unsigned int element) const;

  private:
    unsigned int              p = 0;
    std::vector<double>       t;
    std::vector<unsigned int> spans; // t[spans[e]] < t[spans[e] + 1]
  };



  /**
   * A matrix whose rows have their entries in one run of columns: entry
   * (i, first_column[i] + k) is values[i * width + k].
   */
  struct BandedMatrix
  {
    unsigned int              n_rows    = 0;
    unsigned int              n_columns = 0;
    unsigned int              width     = 0;
    std::vector<unsigned int> first_column;
    std::vector<double>       values;

    /**
     * An entry, zero outside the run.
     */
    double
    operator()(const unsigned int i, const unsigned int j) const
    {
      const unsigned int k = j - first_column[i];
      return (j >= first_column[i] && k < width) ? values[i * width + k] : 0.;
    }
  };

  /**
   * The cross matrix int N_i^rows N_j^columns dx of two knot vectors with the
   * same elements, exact by Gauss quadrature. With twice the same argument it
   * is the mass matrix.
   */
  BandedMatrix
  cross_matrix(const KnotVector &rows, const KnotVector &columns);
} // namespace greville

#endif

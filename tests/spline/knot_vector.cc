// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks univariate splines against their definition: partition of unity,
// derivatives against difference quotients, Bezier extraction, blossom,
// Greville abscissae, cross matrices; on uniform and general open knot vectors.

#include <deal.II/base/polynomials_bernstein.h>

#include <tests.h>

namespace
{
  double
  value(const KnotVector &knots, const unsigned int i, const double x)
  {
    const unsigned int  e = knots.find_element(x);
    std::vector<double> values(knots.degree() + 1);
    knots.evaluate(e, x, 0, make_array_view(values));
    const unsigned int a = i - knots.first_function(e);
    return a < values.size() ? values[a] : 0.;
  }

  // The definition, by recursion.
  double
  cox_de_boor(const std::vector<double> &t,
              const unsigned int         i,
              const unsigned int         p,
              const double               x)
  {
    if (p == 0)
      return t[i] <= x && x < t[i + 1];
    double       sum  = 0;
    const double left = t[i + p] - t[i], right = t[i + p + 1] - t[i + 1];
    if (left > 0)
      sum += (x - t[i]) / left * cox_de_boor(t, i, p - 1, x);
    if (right > 0)
      sum += (t[i + p + 1] - x) / right * cox_de_boor(t, i + 1, p - 1, x);
    return sum;
  }

  void
  test(const std::string &name, const KnotVector &knots)
  {
    const unsigned int  p = knots.degree(), n = knots.n_functions();
    std::vector<double> v(p + 1), v1(p + 1), v2(p + 1), low(p + 1), high(p + 1);

    double recursion = 0, unity = 0, first = 0, second = 0, extraction = 0,
           identity = 0, dual = 0, line = 0;
    for (unsigned int e = 0; e < knots.n_elements(); ++e)
      {
        const double a = knots.element_lower(e), h = knots.element_upper(e) - a;
        const auto   C = knots.extraction_matrix(e);
        for (const double xi : {0.1, 0.4, 0.9})
          {
            const double x = a + h * xi, d = 1e-4 * h;
            knots.evaluate(e, x, 0, make_array_view(v));
            knots.evaluate(e, x, 1, make_array_view(v1));
            knots.evaluate(e, x, 2, make_array_view(v2));
            knots.evaluate(e, x - d, 0, make_array_view(low));
            knots.evaluate(e, x + d, 0, make_array_view(high));
            double sum = -1, sum_x = -x;
            for (unsigned int k = 0; k <= p; ++k)
              {
                const unsigned int i = knots.first_function(e) + k;
                recursion =
                  std::max(recursion,
                           std::abs(v[k] -
                                    cox_de_boor(knots.knots(), i, p, x)));
                sum += v[k];
                sum_x += v[k] * knots.greville_abscissa(i);
                first =
                  std::max(first,
                           std::abs((high[k] - low[k]) / (2 * d) - v1[k]) * h);
                second =
                  std::max(second,
                           std::abs((high[k] - 2 * v[k] + low[k]) / (d * d) -
                                    v2[k]) *
                             h * h);
                double bernstein = 0;
                for (unsigned int b = 0; b <= p; ++b)
                  bernstein +=
                    C(k, b) * PolynomialsBernstein<double>(b, p).value(xi);
                extraction = std::max(extraction, std::abs(bernstein - v[k]));
              }
            unity = std::max(unity, std::abs(sum));
            line  = std::max(line, std::abs(sum_x));
          }

        // The dual functionals on the element: coefficient i of function j.
        for (unsigned int k = 0; k <= p; ++k)
          {
            const unsigned int i = knots.first_function(e) + k;
            knots.blossom(e,
                          ArrayView<const double>(knots.knots().data() + i + 1,
                                                  p),
                          make_array_view(v));
            for (unsigned int l = 0; l <= p; ++l)
              dual = std::max(dual, std::abs(v[l] - (l == k)));
          }
      }
    for (const auto *x : {&recursion, &unity, &line, &extraction, &dual})
      identity = std::max(identity, *x);

    check(name + ", p = " + std::to_string(p) + ", identities",
          identity,
          1e-12);
    check("  derivatives", std::max(first * 1e-1, second * 1e-2), 1e-5);

    // Row sums of the mass matrix are the integrals (t_(i+p+1)-t_i) / (p+1).
    const BandedMatrix M     = cross_matrix(knots, knots);
    double             error = 0, symmetry = 0;
    for (unsigned int i = 0; i < n; ++i)
      {
        double sum = -(knots.knots()[i + p + 1] - knots.knots()[i]) / (p + 1.);
        for (unsigned int j = 0; j < n; ++j)
          {
            sum += M(i, j);
            symmetry = std::max(symmetry, std::abs(M(i, j) - M(j, i)));
          }
        error = std::max(error, std::abs(sum));
      }
    check("  mass matrix", std::max(error, symmetry), 1e-14);
  }
} // namespace



void
test_main()
{
  for (unsigned int p = 1; p <= 6; ++p)
    {
      test("uniform", KnotVector::open_uniform(p, 7, -1., 2.));
      test("one element", KnotVector::open_uniform(p, 1));
      std::vector<double> knots(p + 1, 0.);
      knots.insert(knots.end(), {0.1, 0.35, 0.5});
      knots.insert(knots.end(), p, 0.8); // C^0 there
      knots.insert(knots.end(), p + 1, 1.);
      test("general", KnotVector(p, knots));
    }

  // A cross matrix of two orders against a finer quadrature.
  const KnotVector a       = KnotVector::open_uniform(3, 5),
                   b       = KnotVector::open_uniform(2, 5);
  const BandedMatrix P     = cross_matrix(a, b);
  double             error = 0;
  const unsigned int n     = 20000;
  for (unsigned int i = 0; i < a.n_functions(); ++i)
    for (unsigned int j = 0; j < b.n_functions(); ++j)
      {
        double sum = 0;
        for (unsigned int q = 0; q < n; ++q)
          sum += value(a, i, (q + 0.5) / n) * value(b, j, (q + 0.5) / n) / n;
        error = std::max(error, std::abs(sum - P(i, j)));
      }
  check("cross matrix", error, 1e-8);

  for (const std::vector<double> &bad :
       {std::vector<double>{0, 0, 1},
        std::vector<double>{0, 0, 1, 0.5, 2, 2},
        std::vector<double>{0, 0.1, 0.5, 1, 1},
        std::vector<double>{0, 0, 0.5, 0.5, 1, 1}})
    try
      {
        KnotVector(1, bad);
        print() << "accepted" << std::endl;
      }
    catch (const std::exception &error)
      {
        print() << message_of(error) << std::endl;
      }
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks the language of formulas, row by row of doc/user/formulas.md, named
// formulas and their precomputed values, and error messages that name the
// parameter.
#include <greville/base/expression.h>
#include <greville/base/named_formulas.h>

#include <cmath>
#include <map>
#include <tests.h>

namespace
{
  void
  gives(const std::string &formula, const double expected)
  {
    const Expression e(formula, "P", {"x", "t"});
    const double     values[2] = {0.7, -1.};
    const double     value     = e(ArrayView<const double>(values, 2));
    check(formula, std::abs(value - expected), 1e-14);
    // greville_benchmark has the same language.
    if (formula.find('t') == std::string::npos)
      check(formula + " as a function",
            std::abs(make_function<2>(formula, "P")->value(Point<2>(0.7, 0.)) -
                     expected),
            1e-14);
  }

  void
  named(const std::map<std::string, std::string> &formulas,
        const std::string                        &formula,
        const double                              expected)
  {
    try
      {
        const NamedFormulas names(formulas, {"ball"});
        const Formulas      f(
          {names.attach(formula)}, "P", {"x", "t", "h"}, {}, {"x"});
        // At another place and time first: no value may be left over.
        const std::vector<double> other = {0.1, 2., 0.5},
                                  here  = {0.7, -1., 0.5};
        std::vector<double> precomputed(f.n_precomputed()),
          of_other(f.n_precomputed()), result(1);
        f.precompute(here, precomputed);
        f.precompute(other, of_other);
        for (unsigned int k = 0; k < 2; ++k)
          {
            check(formula + " with names",
                  std::abs(f.value(0, here) - expected),
                  1e-14);
            f.evaluate(other, of_other, result);
            f.evaluate(here, precomputed, result);
            check(formula + " with values of points",
                  std::abs(result[0] - expected),
                  1e-14);
            f.evaluate(other, of_other, result);
          }
        print() << formula << ": " << f.n_precomputed() << " precomputed"
                << std::endl;
      }
    catch (const std::exception &error)
      {
        print() << message_of(error) << std::endl;
      }
  }

  void
  refused(const std::string &formula)
  {
    try
      {
        const double     values[2] = {0.7, -1.};
        const Expression e(formula, "Loads/Gravity", {"x", "t"});
        print() << formula
                << " is accepted: " << e(ArrayView<const double>(values, 2))
                << std::endl;
        check(formula + " is refused", false);
      }
    catch (const std::exception &error)
      {
        print() << message_of(error) << std::endl;
      }
  }
} // namespace



void
test_main()
{
  const double x = 0.7;
  gives("x + 2 * 3 - 1 / 4", x + 5.75);
  gives("2 ^ 3 ^ 2", 512.);
  gives("-2 ^ 2", -4.);
  gives("1.5e-3", 0.0015);
  gives("x == 0.7", 1.);
  gives("x != 0.7", 0.);
  gives("x < 1", 1.);
  gives("x > 1", 0.);
  gives("x <= 0.7", 1.);
  gives("x >= 0.8", 0.);
  gives("x < 1 && x > 0.5", 1.);
  gives("x < 1 & x > 0.9", 0.);
  gives("x < 0 || x > 0.5", 1.);
  gives("x < 0 | x > 0.9", 0.);
  gives("1 + 1 > 1 | 0", 1.);
  gives("x > 1 ? 3 : 4", 4.);
  gives("if(x > 0.5, 3, 4)", 3.);
  gives("if(t > 0, sqrt(t), 0)", 0.);
  gives("if(x > 0, x, 1 / 0)", x);
  gives("sin(x)", std::sin(x));
  gives("cos(x)", std::cos(x));
  gives("tan(x)", std::tan(x));
  gives("cot(x)", 1. / std::tan(x));
  gives("sec(x)", 1. / std::cos(x));
  gives("csc(x)", 1. / std::sin(x));
  gives("asin(x)", std::asin(x));
  gives("acos(x)", std::acos(x));
  gives("atan(x)", std::atan(x));
  gives("atan2(x, -1)", std::atan2(x, -1.));
  gives("sinh(x)", std::sinh(x));
  gives("cosh(x)", std::cosh(x));
  gives("tanh(x)", std::tanh(x));
  gives("asinh(x)", std::asinh(x));
  gives("acosh(x + 1)", std::acosh(x + 1.));
  gives("atanh(x)", std::atanh(x));
  gives("exp(x)", std::exp(x));
  gives("ln(x)", std::log(x));
  gives("log(x)", std::log(x));
  gives("log2(x)", std::log2(x));
  gives("log10(x)", std::log10(x));
  gives("sqrt(x)", std::sqrt(x));
  gives("pow(x, 3)", std::pow(x, 3));
  gives("erf(x)", std::erf(x));
  gives("erfc(x)", std::erfc(x));
  gives("abs(-x)", x);
  gives("sign(-x)", -1.);
  gives("floor(-x)", -1.);
  gives("ceil(x)", 1.);
  gives("rint(x)", 1.);
  gives("int(x)", 1.);
  gives("mod(-x, 0.5)", 0.3);
  gives("min(1, x, 2)", x);
  gives("max(1, x, 2)", 2.);
  gives("sum(1, x, 2)", 3.7);
  gives("avg(1, x, 1)", 0.9);
  gives("pi + _pi", 2. * numbers::PI);
  gives("_e", numbers::E);

  for (const std::string formula : {"0,5",
                                    "(0,5) * x",
                                    "x = 3",
                                    "x += 3",
                                    "sin(x",
                                    "pow(x)",
                                    "sin(0,5)",
                                    "x**2",
                                    "true",
                                    "",
                                    "  ",
                                    "1 / 0",
                                    "sqrt(-x)",
                                    "1e300",
                                    "nan",
                                    "x; t"})
    refused(formula);

  named({{"a", "b + x"}, {"b", "2 * t"}}, "a * b", (-2. + x) * -2.);
  // A formula means its own variables.
  named({{"h", "3"}, {"a", "h * x"}}, "a + h", 3. * x + 0.5);
  named({{"r", "sin(x)"}, {"q", "r^2"}, {"s", "2 * q * t"}, {"k", "3"}},
        "q + s + k * x",
        std::pow(std::sin(x), 2) * (1. + 2. * -1.) + 3. * x);
  const double none = 0.;
  named({{"a", "b"}, {"b", "sin(a)"}}, "x", none);
  named({{"a", "a + 1"}}, "x", none);
  named({{"a", "c"}}, "x", none);
  named({{"a", "Y"}}, "a", none);
  for (const std::string name : {"x", "t", "pi", "sin", "ball", "1a", "a b"})
    named({{name, "1"}}, "x", none);
}

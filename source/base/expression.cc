// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/expression.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cctype>
#include <cmath>
#include <muParser.h>
#include <sstream>

namespace greville
{
  using namespace dealii;

  class Expression::Parser
  {
  public:
    [[noreturn]] void
    fail(const std::string &reason) const
    {
      AssertThrow(false,
                  ExcMessage("The formula <" + text + "> of the parameter '" +
                             parameter + "' " + reason));
      std::abort();
    }

    std::string              text, parameter;
    std::vector<std::string> variables;
    mu::Parser               parser;
    std::vector<double>      values;
  };



  namespace
  {
    // Larger values overflow where they are squared.
    constexpr double largest_value = 1e100;



    bool
    is_letter(const char c)
    {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    }



    /**
     * What muParser accepts and hardly anybody means: assignments, and commas
     * outside of the arguments of a function, of which the last value counts.
     * Returns the reason, or nothing.
     */
    std::string
    trap_in(const std::string &text)
    {
      std::vector<bool> is_call; // for each open parenthesis
      char              last = ' ', word_end = ' ';
      for (std::size_t i = 0; i < text.size(); ++i)
        {
          const char c    = text[i];
          const char next = i + 1 < text.size() ? text[i + 1] : ' ';
          if (c == '=' && next != '=' && last != '=' && last != '<' &&
              last != '>' && last != '!')
            return "has an assignment: equality is written ==.";
          if (c == '(')
            is_call.push_back(is_letter(word_end));
          else if (c == ')' && !is_call.empty())
            is_call.pop_back();
          else if (c == ',' && (is_call.empty() || !is_call.back()))
            return "has a comma outside of the arguments of a function: the "
                   "decimal separator is a point (0.5), formulas are "
                   "separated by semicolons.";
          last = c;
          if (c != ' ' && c != '\t')
            word_end = c;
        }
      return "";
    }



    // What muParser does not have, or has under other names.
    void
    define_functions(mu::Parser &parser)
    {
      // muParser's own _pi and _e have 13 digits.
      parser.DefineConst("pi", numbers::PI);
      parser.DefineConst("_pi", numbers::PI);
      parser.DefineConst("_e", numbers::E);
      parser.DefineFun(
        "if", +[](double condition, double yes, double no) {
          return condition != 0. ? yes : no;
        });
      parser.DefineFun(
        "pow", +[](double x, double y) { return std::pow(x, y); });
      parser.DefineFun(
        "atan2", +[](double y, double x) { return std::atan2(y, x); });
      parser.DefineFun(
        "mod", +[](double x, double y) { return x - y * std::floor(x / y); });
      parser.DefineFun(
        "cot", +[](double x) { return 1. / std::tan(x); });
      parser.DefineFun(
        "sec", +[](double x) { return 1. / std::cos(x); });
      parser.DefineFun(
        "csc", +[](double x) { return 1. / std::sin(x); });
      parser.DefineFun(
        "floor", +[](double x) { return std::floor(x); });
      parser.DefineFun(
        "ceil", +[](double x) { return std::ceil(x); });
      parser.DefineFun(
        "int", +[](double x) { return std::round(x); });
      parser.DefineFun(
        "erf", +[](double x) { return std::erf(x); });
      parser.DefineFun(
        "erfc", +[](double x) { return std::erfc(x); });
      parser.DefineOprt(
        "&", +[](double a, double b) { return double(a != 0. && b != 0.); }, 1);
      parser.DefineOprt(
        "|", +[](double a, double b) { return double(a != 0. || b != 0.); }, 0);
    }
  } // namespace



  Expression::Expression(const std::string              &text,
                         const std::string              &parameter,
                         const std::vector<std::string> &variables,
                         const std::vector<Function>    &functions)
    : parser(std::make_shared<Parser>())
  {
    parser->text      = text;
    parser->parameter = parameter;
    parser->variables = variables;
    parser->values.assign(variables.size(), 0.);
    if (text.find_first_not_of(" \t") == std::string::npos)
      parser->fail("is empty.");
    const std::string trap = trap_in(text);
    if (!trap.empty())
      parser->fail(trap);
    try
      {
        for (unsigned int i = 0; i < variables.size(); ++i)
          parser->parser.DefineVar(variables[i], &parser->values[i]);
        define_functions(parser->parser);
        for (const Function &function : functions)
          parser->parser.DefineFun(function.name, function.function);
        parser->parser.SetExpr(text);
        parser->parser.Eval();
      }
    catch (const mu::ParserError &error)
      {
        std::string message = error.GetMsg();
        while (!message.empty() && message.back() == '.')
          message.pop_back();
        parser->fail("is no function of " +
                     boost::algorithm::join(variables, ", ") + ": " + message +
                     " (doc/user/formulas.md has all functions).");
      }
    catch (const ExceptionBase &error)
      {
        parser->fail("is wrong: " + message_of(error) + ".");
      }
  }



  double
  Expression::operator()(const ArrayView<const double> &values) const
  {
    AssertThrow(values.size() == parser->values.size(),
                ExcDimensionMismatch(values.size(), parser->values.size()));
    std::copy(values.begin(), values.end(), parser->values.begin());
    double result;
    try
      {
        result = parser->parser.Eval();
      }
    catch (const mu::ParserError &error)
      {
        parser->fail("is wrong: " + error.GetMsg());
      }
    catch (const ExceptionBase &error)
      {
        parser->fail("is wrong: " + message_of(error) + ".");
      }
    // Also false where the result is NaN.
    if (!(std::abs(result) <= largest_value))
      {
        std::ostringstream text;
        text << "is "
             << (std::isnan(result)      ? "NaN"
                 : std::isfinite(result) ? ""
                 : result > 0.           ? "infinite"
                                         : "-infinite");
        if (std::isfinite(result))
          text << result;
        text << " at ";
        for (unsigned int i = 0; i < parser->variables.size(); ++i)
          text << (i > 0 ? ", " : "") << parser->variables[i] << " = "
               << parser->values[i];
        text << (std::isfinite(result) ? ": values are at most 1e100 in size."
                                       : ": it has to be a finite number.");
        parser->fail(text.str());
      }
    return result;
  }



  std::vector<Expression>
  make_expressions(const std::string              &text,
                   const std::string              &parameter,
                   const std::vector<std::string> &variables,
                   const unsigned int              n)
  {
    const auto parts = Utilities::split_string_list(text, ';');
    AssertThrow(parts.size() == n,
                ExcMessage("The parameter '" + parameter + "' takes " +
                           std::to_string(n) +
                           " formulas separated by semicolons, not <" + text +
                           ">."));
    std::vector<Expression> result;
    for (const std::string &part : parts)
      result.emplace_back(part, parameter, variables);
    return result;
  }
} // namespace greville

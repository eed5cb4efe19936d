// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/expression.h>
#include <greville/base/named_formulas.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <muParser.h>
#include <set>
#include <sstream>

namespace greville
{
  using namespace dealii;

  struct Formulas::Formula
  {
    [[noreturn]] void
    fail(const std::string &reason) const
    {
      Require(false,
              "The formula <" + text + "> of the parameter '" + parameter +
                "' " + reason);
      std::abort();
    }

    std::string                 name, text, parameter;
    std::unique_ptr<mu::Parser> parser;
    // The bits of the variables that occur, also through names.
    std::uint64_t             variables = 0;
    std::vector<unsigned int> names;

    // For a name: whether it depends only on constant variables, and whether
    // precompute() returns its value.
    bool is_constant    = false;
    bool is_precomputed = false;
    // The address of its value.
    double *value = nullptr;
  };



  namespace
  {
    // Return the bit of a variable in sets of variables. The last bit is shared
    // by all further variables, which only formulas of statistics columns have.
    std::uint64_t
    bit_of(const std::size_t variable)
    {
      return std::uint64_t(1) << std::min<std::size_t>(variable, 63);
    }



    // Larger values overflow when squared.
    constexpr double largest_value = 1e100;



    std::string
    text_of_value(const double value)
    {
      return std::isnan(value)      ? "NaN"
             : std::isfinite(value) ? text_of(value)
             : value > 0.           ? "infinite"
                                    : "-infinite";
    }



    bool
    is_letter(const char c)
    {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    }



    /// Find errors that muParser accepts: assignments, and commas outside the
    /// arguments of a function, of which it takes the last value. Returns the
    /// reason, or an empty text.
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



    // Define functions that muParser lacks or names differently.
    void
    define_functions(mu::Parser &parser)
    {
      using Function1 = double (*)(double);
      using Function2 = double (*)(double, double);
      // muParser's own _pi and _e have only 13 digits.
      parser.DefineConst("pi", numbers::PI);
      parser.DefineConst("_pi", numbers::PI);
      parser.DefineConst("_e", numbers::E);
      parser.DefineFun(
        "if", +[](double condition, double yes, double no) {
          return condition != 0. ? yes : no;
        });
      parser.DefineFun("pow", Function2(std::pow));
      parser.DefineFun("atan2", Function2(std::atan2));
      parser.DefineFun(
        "mod", +[](double x, double y) { return x - y * std::floor(x / y); });
      parser.DefineFun(
        "cot", +[](double x) { return 1. / std::tan(x); });
      parser.DefineFun(
        "sec", +[](double x) { return 1. / std::cos(x); });
      parser.DefineFun(
        "csc", +[](double x) { return 1. / std::sin(x); });
      parser.DefineFun("floor", Function1(std::floor));
      parser.DefineFun("ceil", Function1(std::ceil));
      parser.DefineFun("int", Function1(std::round));
      parser.DefineFun("erf", Function1(std::erf));
      parser.DefineFun("erfc", Function1(std::erfc));
      parser.DefineOprt(
        "&",
        +[](double a, double b) { return double(a != 0. && b != 0.); },
        mu::prLAND);
      parser.DefineOprt(
        "|",
        +[](double a, double b) { return double(a != 0. || b != 0.); },
        mu::prLOR);
    }



    /// Return the names and formulas that follow a formula.
    std::vector<std::pair<std::string, std::string>>
    definitions_behind(const std::string &text)
    {
      const auto lines = Utilities::split_string_list(text, '\n');
      std::vector<std::pair<std::string, std::string>> result;
      for (unsigned int k = 1; k < lines.size(); ++k)
        {
          const auto equal = lines[k].find('=');
          result.emplace_back(Utilities::trim(lines[k].substr(0, equal)),
                              Utilities::trim(lines[k].substr(equal + 1)));
        }
      return result;
    }
  } // namespace



  Formulas::Formulas(const std::vector<std::string> &texts,
                     const std::string              &parameter,
                     const std::vector<std::string> &variables,
                     const std::vector<Function>    &functions,
                     const std::vector<std::string> &constant_variables)
    : parameter(parameter)
    , variables(variables)
    , functions(functions)
    , constant_variables(constant_variables)
  {
    for (unsigned int i = 0; i < variables.size(); ++i)
      numbers.push_back(0.);
    for (const std::string &text : texts)
      define_names(text);
    for (const std::string &text : texts)
      formulas.push_back(read(formula_text(text), parameter, variables));
    const auto precompute_names_of = [&](const Formula &user) {
      for (const unsigned int k : user.names)
        names[k].is_precomputed =
          names[k].is_precomputed || names[k].is_constant;
    };
    for (const Formula &formula : formulas)
      precompute_names_of(formula);
    for (const Formula &name : names)
      if (!name.is_constant)
        precompute_names_of(name);
  }



  Formulas::~Formulas() = default;



  void
  Formulas::define_names(const std::string &text)
  {
    const auto definitions = definitions_behind(text);
    // Collect from the last name on, since each name follows the names that it
    // uses.
    std::set<std::string> used;
    const auto            use = [&](const std::string &formula) {
      for (const std::string &name : names_in_formula(formula))
        used.insert(name);
    };
    use(formula_text(text));
    for (const std::string &variable : variables)
      used.erase(variable);
    for (auto definition = definitions.rbegin();
         definition != definitions.rend();
         ++definition)
      if (used.count(definition->first) > 0)
        use(definition->second);
    std::vector<std::string> their_variables;
    for (const std::string &variable : variables_of<3>("xXt"))
      if (contains(variables, variable))
        their_variables.push_back(variable);
    for (const auto &named : definitions)
      {
        const std::string &name = named.first;
        const bool         is_known =
          std::any_of(names.begin(), names.end(), [&](const Formula &other) {
            return other.name == name;
          });
        if (used.count(name) == 0 || is_known)
          continue;
        Formula definition =
          read(named.second, "Formulas/" + name, their_variables);
        numbers.push_back(evaluate(definition));
        definition.name        = name;
        definition.value       = &numbers.back();
        std::uint64_t constant = 0;
        for (unsigned int i = 0; i < variables.size(); ++i)
          if (contains(constant_variables, variables[i]))
            constant |= bit_of(i);
        definition.is_constant = definition.variables != 0 &&
                                 (definition.variables & ~constant) == 0 &&
                                 functions.empty();
        names.push_back(std::move(definition));
      }
  }



  Formulas::Formula
  Formulas::read(const std::string              &text,
                 const std::string              &its_parameter,
                 const std::vector<std::string> &its_variables)
  {
    Formula result;
    result.text      = text;
    result.parameter = its_parameter;
    result.parser    = std::make_unique<mu::Parser>();
    if (text.find_first_not_of(" \t") == std::string::npos)
      result.fail("is empty.");
    const std::string trap = trap_in(text);
    if (!trap.empty())
      result.fail(trap);
    const std::vector<std::string> words = names_in_formula(text);
    try
      {
        for (unsigned int i = 0; i < variables.size(); ++i)
          if (contains(its_variables, variables[i]))
            {
              result.parser->DefineVar(variables[i], &numbers[i]);
              if (contains(words, variables[i]))
                result.variables |= bit_of(i);
            }
        for (unsigned int k = 0; k < names.size(); ++k)
          if (contains(words, names[k].name) &&
              !contains(its_variables, names[k].name))
            {
              result.parser->DefineVar(names[k].name, names[k].value);
              result.names.push_back(k);
              result.variables |= names[k].variables;
            }
        define_functions(*result.parser);
        for (const Function &function : functions)
          result.parser->DefineFun(function.name, function.function);
        result.parser->SetExpr(text);
        result.parser->Eval();
      }
    catch (const mu::ParserError &error)
      {
        std::string message = error.GetMsg();
        while (!message.empty() && message.back() == '.')
          message.pop_back();
        result.fail("is no function of " +
                    boost::algorithm::join(variables, ", ") + ": " + message +
                    " (doc/user/formulas.md has all functions).");
      }
    catch (const ExceptionBase &error)
      {
        result.fail("is wrong: " + message_of(error) + ".");
      }
    return result;
  }



  double
  Formulas::evaluate(const Formula &formula) const
  {
    try
      {
        return formula.parser->Eval();
      }
    catch (const mu::ParserError &error)
      {
        formula.fail("is wrong: " + error.GetMsg());
      }
    catch (const ExceptionBase &error)
      {
        formula.fail("is wrong: " + message_of(error) + ".");
      }
  }



  double
  Formulas::checked_value(const unsigned int k) const
  {
    const double result = evaluate(formulas[k]);
    // The comparison is false if the result is NaN.
    if (!(std::abs(result) <= largest_value))
      {
        std::ostringstream text;
        text << "is " << text_of_value(result) << " at ";
        for (unsigned int i = 0; i < variables.size(); ++i)
          text << (i > 0 ? ", " : "") << variables[i] << " = " << numbers[i];
        // Constant names may be out of date if only others were precomputed.
        const auto cause =
          std::find_if(names.begin(), names.end(), [&](const Formula &name) {
            return !(std::abs(*name.value) <= largest_value) &&
                   (name.is_precomputed || !name.is_constant ||
                    !is_out_of_date);
          });
        if (cause != names.end())
          text << " ('" << cause->parameter << "' is "
               << text_of_value(*cause->value) << " there)";
        text << (std::isfinite(result) ? ": values are at most 1e100 in size."
                                       : ": it has to be a finite number.");
        formulas[k].fail(text.str());
      }
    return result;
  }



  void
  Formulas::set(const ArrayView<const double> &values,
                const double                  *precomputed) const
  {
    AssertThrow(values.size() == variables.size(),
                ExcDimensionMismatch(values.size(), variables.size()));
    // Functions may depend on more than their arguments.
    const bool    all = !functions.empty() || (is_out_of_date && !precomputed);
    std::uint64_t changed = all ? ~std::uint64_t(0) : 0;
    for (unsigned int i = 0; i < values.size(); ++i)
      {
        // The comparison also holds if a number is NaN.
        if (!(numbers[i] == values[i]))
          changed |= bit_of(i);
        numbers[i] = values[i];
      }
    is_out_of_date = precomputed != nullptr;
    for (const Formula &name : names)
      if (precomputed && name.is_constant)
        {
          if (name.is_precomputed)
            *name.value = *precomputed++;
        }
      else if ((name.variables & changed) != 0 || !functions.empty())
        *name.value = evaluate(name);
  }



  double
  Formulas::value(const unsigned int             k,
                  const ArrayView<const double> &values) const
  {
    set(values, nullptr);
    return checked_value(k);
  }



  void
  Formulas::evaluate(const ArrayView<const double> &values,
                     const ArrayView<double>       &results) const
  {
    set(values, nullptr);
    for (unsigned int k = 0; k < formulas.size(); ++k)
      results[k] = checked_value(k);
  }



  void
  Formulas::evaluate(const ArrayView<const double> &values,
                     const ArrayView<const double> &precomputed,
                     const ArrayView<double>       &results) const
  {
    set(values, precomputed.data());
    for (unsigned int k = 0; k < formulas.size(); ++k)
      results[k] = checked_value(k);
  }



  unsigned int
  Formulas::n_precomputed() const
  {
    return std::count_if(names.begin(), names.end(), [](const Formula &name) {
      return name.is_precomputed;
    });
  }



  void
  Formulas::precompute(const ArrayView<const double> &values,
                       const ArrayView<double>       &precomputed) const
  {
    set(values, nullptr);
    double *next = precomputed.data();
    for (const Formula &name : names)
      if (name.is_precomputed)
        *next++ = *name.value;
  }



  bool
  Formulas::depends_on(const std::string &variable) const
  {
    const std::uint64_t bit =
      bit_of(std::find(variables.begin(), variables.end(), variable) -
             variables.begin());
    return std::any_of(formulas.begin(),
                       formulas.end(),
                       [&](const Formula &formula) {
                         return (formula.variables & bit) != 0;
                       });
  }



  std::vector<std::string>
  Formulas::known_names()
  {
    mu::Parser parser;
    define_functions(parser);
    std::vector<std::string> result;
    for (const auto &function : parser.GetFunDef())
      result.push_back(function.first);
    for (const auto &constant : parser.GetConst())
      result.push_back(constant.first);
    return result;
  }



  std::vector<std::string>
  names_in_formula(const std::string &text)
  {
    std::vector<std::string> result;
    std::string              word;
    for (const char c : text + ' ')
      // Numbers may be 1.e5.
      if (is_letter(c) || c == '.')
        word += c;
      else
        {
          if (!word.empty() && word[0] != '.' &&
              !std::isdigit(static_cast<unsigned char>(word[0])))
            result.push_back(word);
          word.clear();
        }
    return result;
  }



  std::vector<std::string>
  split_formulas(const std::string &text,
                 const std::string &parameter,
                 const unsigned int n)
  {
    const std::string formulas    = formula_text(text);
    const std::string definitions = text.substr(formulas.size());
    auto              result      = Utilities::split_string_list(formulas, ';');
    Require(result.size() == n,
            "The parameter '" + parameter + "' takes " + std::to_string(n) +
              " formulas separated by semicolons, not <" + formulas + ">.");
    for (std::string &formula : result)
      formula += definitions;
    return result;
  }
} // namespace greville

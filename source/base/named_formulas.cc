// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/expression.h>
#include <greville/base/named_formulas.h>
#include <greville/base/parameter_tree.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/property_tree/ptree.hpp>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Throw if this is not a valid name, or already has another meaning.
    void
    check_name_of_formula(const std::string              &name,
                          const std::vector<std::string> &functions)
    {
      const std::string what =
        "The section 'Formulas' has the name <" + name + ">, which ";
      Require(names_in_formula(name) == std::vector<std::string>{name},
              what + "has to consist of letters, digits and _, and not to "
                     "begin with a digit.");
      Require(!contains(variables_of<3>("xXt"), name),
              what + "is a variable of formulas.");
      Require(!contains(Formulas::known_names(), name) &&
                !contains(functions, name),
              what + "is a function or a constant.");
    }

  } // namespace



  NamedFormulas::NamedFormulas(
    const std::map<std::string, std::string> &formulas,
    const std::vector<std::string>           &functions)
    : formulas(formulas)
  {
    std::vector<Formulas::Function> known;
    for (const std::string &function : functions)
      known.push_back({function, +[](const double *, int) { return 0.; }});
    for (const auto &entry : formulas)
      check_name_of_formula(entry.first, functions);
    for (const auto &[name, text] : formulas)
      {
        std::vector<std::string> path = {name}, order;
        collect(text, path, order);
        Formulas({attach(text)},
                 "Formulas/" + name,
                 variables_of<3>("xXt"),
                 known);
      }
  }



  void
  NamedFormulas::collect(const std::string        &text,
                         std::vector<std::string> &path,
                         std::vector<std::string> &order) const
  {
    for (const std::string &name : names_in_formula(text))
      {
        const auto formula = formulas.find(name);
        if (formula == formulas.end() || contains(order, name))
          continue;
        path.push_back(name);
        Require(std::count(path.begin(), path.end(), name) == 1,
                "The parameter 'Formulas/" + name + "' needs its own value: " +
                  boost::algorithm::join(path, ", ") + ".");
        collect(formula->second, path, order);
        path.pop_back();
        order.push_back(name);
      }
  }



  std::string
  NamedFormulas::attach(const std::string &text) const
  {
    std::vector<std::string> path, order;
    collect(text, path, order);
    std::string result = text;
    for (const std::string &name : order)
      result += '\n' + name + " = " + formulas.at(name);
    return result;
  }



  void
  NamedFormulas::attach_to(ParameterHandler &prm) const
  {
    if (formulas.empty())
      return;
    std::vector<ParameterLine> lines;
    for_each_parameter(
      prm, [&](const auto &path, const auto &name, const auto &entry) {
        if (entry.get("pattern_description", "") == FormulaPattern::name)
          lines.push_back({"", name, entry.get("value", ""), "", path, false});
      });
    for (const ParameterLine &line : lines)
      {
        const std::string text = attach(line.value);
        if (text != line.value && line.path[0] != "Formulas")
          set_parameter(prm, line.path, line.name, text);
      }
  }
} // namespace greville

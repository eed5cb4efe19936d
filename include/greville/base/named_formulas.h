// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  /// The pattern of parameters that are formulas. Any text matches it.
  class FormulaPattern : public dealii::Patterns::PatternBase
  {
  public:
    /// The description of the pattern in ParameterHandler.
    static constexpr const char *name = "[Formula]";

    bool
    match(const std::string &) const override
    {
      return true;
    }

    std::string
    description(const OutputStyle = Machine) const override
    {
      return name;
    }

    std::unique_ptr<PatternBase>
    clone() const override
    {
      return std::make_unique<FormulaPattern>();
    }
  };

  /// Declare a parameter that is a formula and may contain names of the section
  /// 'Formulas'. Used like add_parameter().
  inline auto
  add_formula(dealii::ParameterHandler &prm,
              const std::string        &name,
              std::string              &value)
  {
    return [&prm, &value, name](const std::string &text) {
      prm.add_parameter(name, value, text, FormulaPattern());
    };
  }



  /// The formulas of the section 'Formulas', which other formulas use by their
  /// names.
  class NamedFormulas
  {
  public:
    NamedFormulas() = default;

    /// Throws dealii::ExcMessage for invalid or reserved names, for texts that
    /// are not formulas of positions and time, and for circular definitions.
    /// The formulas may contain @p functions.
    NamedFormulas(const std::map<std::string, std::string> &formulas,
                  const std::vector<std::string>           &functions);

    /// Return the text of a formula, followed by lines "name = formula" for all
    /// names that it needs, each after the names that it uses.
    std::string
    attach(const std::string &text) const;

    /// Call attach() for the values of all parameters of @p prm that have the
    /// FormulaPattern.
    void
    attach_to(dealii::ParameterHandler &prm) const;

  private:
    /// Append to @p order the names that @p text uses, each after the names
    /// that its formula uses. @p path contains the names that lead to the text.
    void
    collect(const std::string        &text,
            std::vector<std::string> &path,
            std::vector<std::string> &order) const;

    std::map<std::string, std::string> formulas;
  };

  /// Return the text of a formula without the definitions that attach()
  /// appends.
  inline std::string
  formula_text(const std::string &text)
  {
    return text.substr(0, text.find('\n'));
  }

  /// Return a formula of the initial position x, y (, z) that may also name it
  /// X, Y (, Z).
  template <int dim>
  std::string
  with_initial_positions(std::string text)
  {
    text.insert(formula_text(text).size(),
                dim == 2 ? "\nX = x\nY = y" : "\nX = x\nY = y\nZ = z");
    return text;
  }
} // namespace greville

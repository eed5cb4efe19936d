// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_named_formulas_h
#define greville_base_named_formulas_h

#include <deal.II/base/parameter_handler.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  /**
   * The pattern of parameters that take formulas. Any text matches it.
   */
  class FormulaPattern : public dealii::Patterns::PatternBase
  {
  public:
    /// Its description in ParameterHandler.
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

  /**
   * Declare a parameter that takes formulas, in which names of the section
   * 'Formulas' may stand. Used as add_parameter().
   */
  inline auto
  add_formula(dealii::ParameterHandler &prm,
              const std::string        &name,
              std::string              &value)
  {
    return [&prm, &value, name](const std::string &text) {
      prm.add_parameter(name, value, text, FormulaPattern());
    };
  }



  /**
   * The formulas of the section 'Formulas', which others use by their names.
   */
  class NamedFormulas
  {
  public:
    NamedFormulas() = default;

    /**
     * Throws dealii::ExcMessage for names that are none or mean something else,
     * for what is no formula of positions and time, and for formulas that use
     * themselves. The formulas may contain @p functions.
     */
    NamedFormulas(const std::map<std::string, std::string> &formulas,
                  const std::vector<std::string>           &functions);

    /**
     * The text of a formula, and in further lines "name = formula" for all
     * names that it needs, each behind those that it uses.
     */
    std::string
    attach(const std::string &text) const;

    /**
     * attach() for the values of all parameters of @p prm that have the
     * FormulaPattern.
     */
    void
    attach_to(dealii::ParameterHandler &prm) const;

  private:
    /**
     * Append to @p order the names that @p text uses, and before each those
     * that its formula uses. @p path has the names on the way to the text.
     */
    void
    collect(const std::string        &text,
            std::vector<std::string> &path,
            std::vector<std::string> &order) const;

    std::map<std::string, std::string> formulas;
  };

  /**
   * The text of a formula without the definitions that attach() appends.
   */
  inline std::string
  formula_text(const std::string &text)
  {
    return text.substr(0, text.find('\n'));
  }

  /**
   * Formulas of the initial positions x, y (, z) with X, Y (, Z) as other names
   * of these.
   */
  template <int dim>
  std::string
  with_initial_positions(std::string text)
  {
    text.insert(formula_text(text).size(),
                dim == 2 ? "\nX = x\nY = y" : "\nX = x\nY = y\nZ = z");
    return text;
  }
} // namespace greville

#endif

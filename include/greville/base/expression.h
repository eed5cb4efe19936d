// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_expression_h
#define greville_base_expression_h

#include <deal.II/base/array_view.h>

#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * A formula of a parameter file, read by muParser: doc/formulas.md has the
   * whole language. Assignments and commas outside of the arguments of a
   * function, which muParser allows, are refused.
   */
  class Expression
  {
  public:
    /**
     * A function that formulas may call with any number of arguments besides
     * the ones of muParser.
     */
    struct Function
    {
      std::string name;
      double (*function)(const double *arguments, int n_arguments);
    };

    /**
     * Throws dealii::ExcMessage where @p text is no formula of @p variables,
     * with the name of the @p parameter.
     */
    Expression(const std::string              &text,
               const std::string              &parameter,
               const std::vector<std::string> &variables,
               const std::vector<Function>    &functions = {});
    /**
     * The value for the @p values of the variables. Throws dealii::ExcMessage,
     * with the parameter and the values of the variables, where it is not
     * finite or above 1e100 in size. Not for several threads at a time.
     */
    double
    operator()(const dealii::ArrayView<const double> &values) const;

  private:
    class Parser;
    std::shared_ptr<Parser> parser; // copies share it
  };

  /**
   * The @p n formulas in @p text, which are separated by semicolons. Throws as
   * Expression, and where there are not @p n of them.
   */
  std::vector<Expression>
  make_expressions(const std::string              &text,
                   const std::string              &parameter,
                   const std::vector<std::string> &variables,
                   const unsigned int              n);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_expression_h
#define greville_base_expression_h

#include <deal.II/base/array_view.h>
#include <deal.II/base/point.h>

#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * A formula of a parameter file, read by muParser: doc/user/formulas.md has
   * the whole language. Assignments and commas outside of the arguments of a
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

  /**
   * x, y (and z): the variables of formulas of the position.
   */
  template <int dim>
  std::vector<std::string>
  coordinate_names()
  {
    return dim == 2 ? std::vector<std::string>{"x", "y"}
                    : std::vector<std::string>{"x", "y", "z"};
  }



  /**
   * A vector whose components are formulas, separated by semicolons in one
   * parameter. Throws as make_expressions(); zero if made without arguments.
   */
  template <int n>
  class VectorExpression
  {
  public:
    VectorExpression() = default;

    VectorExpression(const std::string              &text,
                     const std::string              &parameter,
                     const std::vector<std::string> &variables)
      : components(make_expressions(text, parameter, variables, n))
    {}

    bool
    is_zero() const
    {
      return components.empty();
    }

    dealii::Tensor<1, n>
    operator()(const dealii::ArrayView<const double> &values) const
    {
      dealii::Tensor<1, n> result;
      for (unsigned int k = 0; k < components.size(); ++k)
        result[k] = components[k](values);
      return result;
    }

    /**
     * For formulas of one variable, and of the coordinates.
     */
    dealii::Tensor<1, n>
    operator()(const double t) const
    {
      return (*this)(dealii::ArrayView<const double>(&t, 1));
    }

    template <int dim>
    dealii::Tensor<1, n>
    operator()(const dealii::Point<dim> &x) const
    {
      return (*this)(dealii::ArrayView<const double>(&x[0], dim));
    }

  private:
    std::vector<Expression> components;
  };
} // namespace greville

#endif

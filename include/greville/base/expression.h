// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_expression_h
#define greville_base_expression_h

#include <deal.II/base/point.h>

#include <greville/base/formulas.h>

namespace greville
{
  /**
   * A formula of a parameter file.
   */
  class Expression
  {
  public:
    using Function = Formulas::Function;

    /**
     * Throws as Formulas.
     */
    Expression(const std::string              &text,
               const std::string              &parameter,
               const std::vector<std::string> &variables,
               const std::vector<Function>    &functions = {})
      : formula(std::make_shared<Formulas>(
          std::vector<std::string>{text}, parameter, variables, functions))
    {}

    /// Return the value, as Formulas::value().
    double
    operator()(const dealii::ArrayView<const double> &values) const
    {
      return formula->value(0, values);
    }

  private:
    std::shared_ptr<const Formulas> formula; // copies share it
  };



  /// Return x, y (and z): the variables of formulas of the position.
  template <int dim>
  std::vector<std::string>
  coordinate_names()
  {
    return dim == 2 ? std::vector<std::string>{"x", "y"}
                    : std::vector<std::string>{"x", "y", "z"};
  }



  /**
   * A vector whose components are formulas, separated by semicolons in one
   * parameter. Throws as split_formulas() and Formulas; zero if constructed
   * without arguments.
   */
  template <int n>
  class VectorExpression
  {
  public:
    VectorExpression() = default;

    VectorExpression(const std::string              &text,
                     const std::string              &parameter,
                     const std::vector<std::string> &variables)
      : components(std::make_shared<Formulas>(
          split_formulas(text, parameter, n), parameter, variables))
    {}

    bool
    is_zero() const
    {
      return !components;
    }

    dealii::Tensor<1, n>
    operator()(const dealii::ArrayView<const double> &values) const
    {
      dealii::Tensor<1, n> result;
      if (components)
        components->evaluate(values,
                             dealii::ArrayView<double>(result.begin_raw(), n));
      return result;
    }

    /// Evaluate formulas of one variable, or of the coordinates.
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
    std::shared_ptr<const Formulas> components;
  };
} // namespace greville

#endif

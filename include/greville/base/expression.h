// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>

#include <greville/base/formulas.h>

#include <algorithm>
#include <array>

namespace greville
{
  /// A formula of a parameter file.
  class Expression
  {
  public:
    using Function = Formulas::Function;

    /// Throws like Formulas.
    Expression(const std::string              &text,
               const std::string              &parameter,
               const std::vector<std::string> &variables,
               const std::vector<Function>    &functions = {})
      : formula(std::make_shared<Formulas>(
          std::vector<std::string>{text}, parameter, variables, functions))
    {}

    /// Return the value, like Formulas::value().
    double
    operator()(const dealii::ArrayView<const double> &values) const
    {
      return formula->value(0, values);
    }

  private:
    std::shared_ptr<const Formulas> formula; // copies share it
  };



  /// Return the variables for which the letters of @p kinds stand: x, y (and
  /// z); X, Y (and Z); t.
  template <int dim>
  std::vector<std::string>
  variables_of(const std::string &kinds)
  {
    std::vector<std::string> result;
    for (const char kind : kinds)
      for (unsigned int d = 0; d < (kind == 't' ? 1 : dim); ++d)
        result.emplace_back(1, char(kind + d));
    return result;
  }

  /// Return the values of variables_of("xXt").
  template <int dim>
  std::array<double, 2 * dim + 1>
  arguments_of(const dealii::Point<dim> &x,
               const dealii::Point<dim> &X,
               const double              t)
  {
    std::array<double, 2 * dim + 1> result;
    std::copy_n(x.begin_raw(), dim, result.begin());
    std::copy_n(X.begin_raw(), dim, result.begin() + dim);
    result.back() = t;
    return result;
  }

  /// Return x, y (and z): the variables of formulas of the position.
  template <int dim>
  std::vector<std::string>
  coordinate_names()
  {
    return variables_of<dim>("x");
  }



  /// A vector whose components are formulas, separated by semicolons in one
  /// parameter. Throws like split_formulas() and Formulas. It is zero if
  /// constructed without arguments.
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

    /// Evaluate formulas of one variable, of the coordinates, or of both.
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

    template <int dim>
    dealii::Tensor<1, n>
    operator()(const dealii::Point<dim> &x, const double t) const
    {
      std::array<double, dim + 1> values;
      std::copy_n(x.begin_raw(), dim, values.begin());
      values[dim] = t;
      return (*this)(dealii::ArrayView<const double>(values.data(), dim + 1));
    }

  private:
    std::shared_ptr<const Formulas> components;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/expression.h>
#include <greville/base/named_formulas.h>
#include <greville/spline/spline_space.h>

#include <array>

namespace greville::internal
{
  /// Return the formulas of an initial displacement or velocity; zero if the
  /// text is empty.
  template <int dim>
  VectorExpression<dim>
  initial_formulas(const std::string &text, const std::string &parameter)
  {
    return text.empty()
             ? VectorExpression<dim>()
             : VectorExpression<dim>(with_initial_positions<dim>(text),
                                     parameter,
                                     coordinate_names<dim>());
  }

  /// Return derivatives of formulas by sixth-order differences with the given
  /// @p steps.
  template <int dim>
  dealii::Tensor<2, 3>
  gradient_of(const VectorExpression<dim>   &formulas,
              const dealii::Point<dim>      &x,
              const std::array<double, dim> &steps)
  {
    static constexpr double weights[3] = {3. / 4., -3. / 20., 1. / 60.};
    dealii::Tensor<2, 3>    gradient;
    for (unsigned int j = 0; j < dim; ++j)
      for (int k = 1; k <= 3; ++k)
        for (const int side : {-1, 1})
          {
            dealii::Point<dim> shifted = x;
            shifted[j] += side * k * steps[j];
            const dealii::Tensor<1, dim> value = formulas(shifted);
            for (unsigned int i = 0; i < dim; ++i)
              gradient[i][j] += side * weights[k - 1] / steps[j] * value[i];
          }
    return gradient;
  }

  /// Return the steps of gradient_of() for an initial displacement.
  template <int dim>
  std::array<double, dim>
  displacement_steps(const SplineSpace<dim> &space)
  {
    std::array<double, dim> steps;
    for (unsigned int d = 0; d < dim; ++d)
      steps[d] = 2e-3 * space.cell_size(d);
    return steps;
  }
} // namespace greville::internal

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>

#include <greville/base/expression.h>

#include <optional>
#include <string>

namespace greville
{
  /**
   * The pressure of water at rest below a water table,
   *   p(x) = rho_w g (s(x) - y), at least -suction,
   * with the height s of the table above x and the height y of x, both upwards
   * along the axis of gravity. Without a table, it is 0 everywhere.
   */
  template <int dim>
  class WaterTable
  {
  public:
    WaterTable() = default;

    /// @p table is a formula, m, or empty for no table. @p density is the
    /// density of water, kg / m^3; the suction is in Pa, 0 for no bound. Throws
    /// dealii::ExcMessage for invalid formulas, and if gravity (m / s^2) is not
    /// along an axis.
    WaterTable(const std::string            &table,
               const double                  density,
               const double                  suction,
               const dealii::Tensor<1, dim> &gravity);

    /// Return the pressure, Pa. Throws dealii::ExcMessage if the formula has no
    /// value.
    double
    operator()(const dealii::Point<dim> &x) const;

    bool
    is_given() const
    {
      return height.has_value();
    }

  private:
    std::optional<VectorExpression<1>> height;
    double                             weight  = 0.; // N / m^3, upwards
    double                             suction = 0.;
    unsigned int                       axis    = 0;
  };
} // namespace greville

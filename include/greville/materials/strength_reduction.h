// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/numbers.h>
#include <deal.II/base/parameter_handler.h>

#include <greville/base/expression.h>
#include <greville/base/named_formulas.h>
#include <greville/materials/parameter_checks.h>

#include <cmath>
#include <optional>

namespace greville
{
  /// A factor r(t) that divides the cohesion and tan(phi) of a frictional law.
  /// The value at which a slope fails is the factor of safety (@ref Matsui1992
  /// "Matsui and San, 1992"). The apex c cot(phi) does not move.
  class StrengthReduction
  {
  public:
    void
    declare(dealii::ParameterHandler &prm)
    {
      add_formula(prm, "Strength reduction", text)(
        "Divisor of cohesion and tan(friction angle) at the end of each step: "
        "a positive formula of t (s). The dilatancy angle is at most the "
        "reduced friction angle. Unit: none.");
    }

    /// Parse the formula. Throws dealii::ExcMessage if it is not a formula of t
    /// or not positive at t = 0.
    void
    reinit(const std::string &section)
    {
      parameter = section + "/Strength reduction";
      formula.reset();
      if (text != "1")
        formula.emplace(text, parameter, std::vector<std::string>{"t"});
      at(0.);
    }

    /// Return the factor. Throws dealii::ExcMessage if it is not positive.
    double
    at(const double time) const
    {
      if (!formula)
        return 1.;
      const double value =
        (*formula)(dealii::ArrayView<const double>(&time, 1));
      Require(value > 0.,
              "The formula <" + formula_text(text) + "> of the parameter '" +
                parameter + "' is " + text_of(value) +
                " at t = " + text_of(time) + "; it has to be greater than 0.");
      return value;
    }

    bool
    changes_strength() const
    {
      return formula.has_value();
    }

    /// Return the angle (radians) whose tangent is tan(@p degrees) /
    /// @p reduction.
    static double
    reduced_angle(const double degrees, const double reduction)
    {
      const double angle = degrees * (dealii::numbers::PI / 180.);
      return reduction == 1. ? angle : std::atan(std::tan(angle) / reduction);
    }

  private:
    std::string               text = "1", parameter;
    std::optional<Expression> formula;
  };
} // namespace greville

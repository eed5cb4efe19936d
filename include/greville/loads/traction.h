// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/named_formulas.h>
#include <greville/loads/surface_load.h>

namespace greville
{
  /// A traction t(x, X, t), Pa, per initial area or, multiplied by |J F^-T N|,
  /// per current area.
  class Traction : public SurfaceLoadKindOf<Traction>
  {
  public:
    static constexpr const char *name = "traction";

    void
    declare(dealii::ParameterHandler &prm) override
    {
      add_formula(prm, "Traction", traction)(
        "Force of constant direction per area: formulas of x, y (, z), the "
        "initial positions X, Y (, Z) and t, separated by semicolons. Unit: "
        "Pa.");
      add_choice<bool>(prm,
                       "Area",
                       per_current_area,
                       {{false, "initial"}, {true, "current"}})(
        "The area of 'Traction'.");
    }

    std::vector<std::pair<std::string, std::string>>
    strengths() const override
    {
      return {{"Traction", traction}};
    }

    template <int dim>
    class Load : public SurfaceLoad<dim>
    {
    public:
      Load(const Traction &kind, const LoadedBody &body)
        : formula(kind.traction,
                  body.section + "/Traction",
                  variables_of<dim>("xXt"))
        , per_current_area(kind.per_current_area)
      {}

      dealii::Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double t) const override
      {
        const double area = per_current_area ? state.area_vector().norm() : 1.;
        return area * formula(arguments_of(state.x, state.X, t));
      }

    private:
      const VectorExpression<dim> formula;
      const bool                  per_current_area;
    };

  private:
    std::string traction;
    bool        per_current_area = false;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/named_formulas.h>
#include <greville/loads/surface_load.h>

namespace greville
{
  /// A pressure p(x, X, t), Pa, against the current normal: -p J F^-T N.
  class Pressure : public SurfaceLoadKindOf<Pressure>
  {
  public:
    static constexpr const char *name = "pressure";

    void
    declare(dealii::ParameterHandler &prm) override
    {
      add_formula(prm, "Pressure", pressure)(
        "Force against the normal, which turns with the surface, per current "
        "area; positive values press: a formula of x, y (, z), the initial "
        "positions X, Y (, Z) and t. Unit: Pa.");
    }

    std::vector<std::pair<std::string, std::string>>
    strengths() const override
    {
      return {{"Pressure", pressure}};
    }

    template <int dim>
    class Load : public SurfaceLoad<dim>
    {
    public:
      Load(const Pressure &kind, const LoadedBody &body)
        : formula(kind.pressure,
                  body.section + "/Pressure",
                  variables_of<dim>("xXt"))
      {}

      dealii::Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double t) const override
      {
        return -formula(arguments_of(state.x, state.X, t))[0] *
               state.area_vector();
      }

    private:
      const VectorExpression<1> formula;
    };

  private:
    std::string pressure;
  };
} // namespace greville

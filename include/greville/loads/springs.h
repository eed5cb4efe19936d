// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/named_formulas.h>
#include <greville/loads/surface_load.h>

namespace greville
{
  /// Springs of stiffness k (Pa / m) that pull points to their initial
  /// positions plus u: -k (x - X - u(X, t)).
  template <int dim>
  class SpringLoad : public SurfaceLoad<dim>
  {
  public:
    /// Construct with zero displacement if its text is empty.
    SpringLoad(const double       k,
               const std::string &displacement,
               const std::string &parameter)
      : k(k)
    {
      if (!displacement.empty())
        formulas = {displacement, parameter, variables_of<dim>("Xt")};
    }

    dealii::Tensor<1, dim>
    load(const SurfaceState<dim> &state, const double t) const override
    {
      return -k * (state.x - state.X - formulas(state.X, t));
    }

    double
    stiffness() const override
    {
      return k;
    }

  private:
    const double          k;
    VectorExpression<dim> formulas;
  };



  /// Springs to the initial positions: an elastic foundation.
  class Springs : public SurfaceLoadKindOf<Springs>
  {
  public:
    static constexpr const char *name = "spring";

    void
    declare(dealii::ParameterHandler &prm) override
    {
      add_parameter(prm, "Stiffness", stiffness, dealii::Patterns::Double(0.))(
        "k of the force -k (x - X) per initial area. Unit: Pa / m.");
    }

    std::vector<std::pair<std::string, std::string>>
    strengths() const override
    {
      return {{"Stiffness", stiffness > 0. ? text_of(stiffness) : ""}};
    }

    template <int dim>
    struct Load : SpringLoad<dim>
    {
      Load(const Springs &kind, const LoadedBody &)
        : SpringLoad<dim>(kind.stiffness, "", "")
      {}
    };

  private:
    double stiffness = 0.;
  };



  /// A displacement u(X, t) that springs impose.
  class GivenDisplacement : public SurfaceLoadKindOf<GivenDisplacement>
  {
  public:
    static constexpr const char *name = "displacement";

    void
    declare(dealii::ParameterHandler &prm) override
    {
      add_formula(prm, "Displacement", displacement)(
        "Displacement u that springs impose: formulas of the initial positions "
        "X, Y (, Z) and t, separated by semicolons. Unit: m.");
      add_parameter(prm, "Stiffness", stiffness, dealii::Patterns::Double(0.))(
        "k of these springs, -k (x - X - u) per initial area. 0: 10 times the "
        "modulus of pressure waves of the material over the smallest edge of a "
        "cell, h. The error of the displacement is then h / 10 times the "
        "strain at the surface. Unit: Pa / m.");
    }

    std::vector<std::pair<std::string, std::string>>
    strengths() const override
    {
      return {{"Displacement", displacement},
              {"Stiffness", stiffness > 0. ? text_of(stiffness) : ""}};
    }

    template <int dim>
    struct Load : SpringLoad<dim>
    {
      Load(const GivenDisplacement &kind, const LoadedBody &body)
        : SpringLoad<dim>(kind.stiffness_on(body),
                          kind.displacement,
                          body.section + "/Displacement")
      {}
    };

  private:
    double
    stiffness_on(const LoadedBody &body) const
    {
      constexpr double factor = 10.;
      if (stiffness > 0.)
        return stiffness;
      const Moduli moduli = body.material.moduli();
      return factor * (moduli.bulk + 4. / 3. * moduli.shear) / body.cell_size;
    }

    std::string displacement;
    double      stiffness = 0.;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/boundary/point_load.h>

namespace greville
{
  /// A force b(x, X, t) per mass on all points, given by formulas. Named
  /// formulas of X alone are precomputed and stored in the points.
  template <int dim>
  class BodyForce : public PointLoad<dim>
  {
  public:
    static PointLoads<dim>
    make(const SimulationParameters &parameters)
    {
      PointLoads<dim> result;
      if (!parameters.loads.body_force.empty())
        result.push_back(std::make_unique<BodyForce>(parameters.loads));
      return result;
    }

    BodyForce(const LoadParameters &parameters)
      : formulas(split_formulas(parameters.body_force, parameter, dim),
                 parameter,
                 variables_of<dim>("xXt"),
                 {},
                 variables_of<dim>("X"))
      , n_precomputed(formulas.n_precomputed())
      , field("load_terms_" + std::to_string(n_precomputed))
    {
      for (const std::string &name : coordinate_names<dim>())
        use_position = use_position || formulas.depends_on(name);
    }

    std::string
    parameter_names() const override
    {
      return std::string("'") + parameter + "'";
    }

    void
    add_fields(PointLayout<dim> &layout) const override
    {
      if (n_precomputed > 0)
        layout.add(field, n_precomputed);
    }

    void
    precompute(MaterialPoints<dim> &points) const override
    {
      if (n_precomputed == 0)
        return;
      const unsigned int  first = points.layout().first(field);
      std::vector<double> values(n_precomputed);
      points.for_each([&](PointRef<dim> p) {
        formulas.precompute(arguments_of(p.position(), p.reference(), 0.),
                            values);
        for (unsigned int k = 0; k < n_precomputed; ++k)
          p[first + k] = values[k];
      });
    }

    void
    add_acceleration(MaterialPoints<dim> &points,
                     const unsigned int   first,
                     const double         t) const override
    {
      const unsigned int first_value =
        n_precomputed > 0 ? points.layout().first(field) : 0;
      std::vector<double> values(n_precomputed);
      points.for_each([&](PointRef<dim> p) {
        for (unsigned int k = 0; k < n_precomputed; ++k)
          values[k] = p[first_value + k];
        std::array<double, dim> result;
        formulas.evaluate(arguments_of(p.position(), p.reference(), t),
                          values,
                          result);
        for (unsigned int d = 0; d < dim; ++d)
          p[first + d] += result[d];
      });
    }

    typename PointLoad<dim>::AtPosition
    at_position(const PointLayout<dim> &, const double t) const override
    {
      if (!use_position)
        return {};
      return
        [this, t](const ConstPointRef<dim> p, const dealii::Point<dim> &x) {
          dealii::Tensor<1, dim> result;
          formulas.evaluate(arguments_of(x, p.reference(), t),
                            dealii::ArrayView<double>(result.begin_raw(), dim));
          return result;
        };
    }

  private:
    static constexpr const char *parameter = "Loads/Body force";

    const Formulas     formulas;
    const unsigned int n_precomputed;
    /// The field of precomputed values. Its name includes their number, which
    /// may differ in another stage.
    const std::string field;
    bool              use_position = false;
  };
} // namespace greville

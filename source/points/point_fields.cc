// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_fields.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    double
    mean_pressure(const SymmetricTensor<2, 3> &stress)
    {
      return -trace(stress) / 3.;
    }



    /// Return the value of a field that not all bodies have; 0 without it.
    template <int dim>
    double
    value_of(const ConstPointRef<dim> p,
             const Body<dim>         &body,
             const std::string       &name)
    {
      const PointField *field = body.points.layout().find(name);
      return field ? p[field->first] : 0.;
    }



    template <int dim>
    void
    add_history(std::vector<OutputField<dim>> &fields,
                const BodyList<dim>           &bodies)
    {
      std::vector<std::string> names;
      for (const Body<dim> &body : bodies)
        for (const std::string &name : body.material->state_names())
          if (!contains(names, name))
            names.push_back(name);
      for (const std::string &name : names)
        fields.push_back(
          {"history",
           {name},
           false,
           [name](const ConstPointRef<dim> p,
                  const Body<dim>         &body,
                  const unsigned int,
                  double *values) { values[0] = value_of(p, body, name); }});
    }



    template <int dim, typename Value>
    OutputField<dim>
    vector_field(const std::string &name, const Value &value)
    {
      return {name,
              std::vector<std::string>(dim, name),
              true,
              [value](const ConstPointRef<dim> p,
                      const Body<dim> &,
                      const unsigned int,
                      double *values) {
                const Tensor<1, dim> vector = value(p);
                for (unsigned int d = 0; d < dim; ++d)
                  values[d] = vector[d];
              }};
    }



    template <int dim, typename Write>
    OutputField<dim>
    tensor_field(const std::string              &name,
                 const std::vector<std::string> &components,
                 const Write                    &write)
    {
      return {name,
              components,
              false,
              [write](const ConstPointRef<dim> p,
                      const Body<dim> &,
                      const unsigned int,
                      double *values) { write(p, values); }};
    }



    /// @p value takes a point, its body and the number of the body.
    template <int dim, typename Value>
    OutputField<dim>
    scalar_field(const std::string &name, const Value &value)
    {
      return {name,
              {name},
              false,
              [value](const ConstPointRef<dim> p,
                      const Body<dim>         &body,
                      const unsigned int       b,
                      double *values) { values[0] = value(p, body, b); }};
    }



    template <int dim>
    void
    write_strain(const ConstPointRef<dim> p, double *values)
    {
      const Tensor<2, 3> F = p.F();
      const Tensor<2, 3> E =
        0.5 * (transpose(F) * F - unit_symmetric_tensor<3>());
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j)
          if (dim == 3 || i == j || j < 2)
            values[PointLayout<dim>::stress_index(i, j)] = E[i][j];
    }



    /// Return all fields except the history.
    template <int dim>
    std::vector<OutputField<dim>>
    all_fields(const unsigned int process)
    {
      using Layout      = PointLayout<dim>;
      using Ref         = ConstPointRef<dim>;
      const auto scalar = [](const std::string &name, const auto &value) {
        return scalar_field<dim>(name,
                                 [value](const Ref p,
                                         const Body<dim> &,
                                         const unsigned int) -> double {
                                   return value(p);
                                 });
      };
      return {
        vector_field<dim>("velocity", [](const Ref p) { return p.velocity(); }),
        vector_field<dim>("displacement",
                          [](const Ref p) {
                            return p.position() - p.reference();
                          }),
        tensor_field<dim>("stress",
                          symmetric_entries<dim>("stress"),
                          [](const Ref p, double *values) {
                            for (unsigned int k = 0; k < Layout::n_stress; ++k)
                              values[k] = p.stress(k);
                          }),
        scalar("pressure",
               [](const Ref p) { return mean_pressure(p.stress()); }),
        scalar("von_mises",
               [](const Ref p) {
                 return std::sqrt(1.5) * deviator(p.stress()).norm();
               }),
        scalar("J", [](const Ref p) { return p.J(); }),
        scalar("density", [](const Ref p) { return p.mass() / p.volume(); }),
        scalar_field<dim>("body",
                          [](const Ref, const Body<dim> &, const unsigned int b)
                            -> double { return b; }),
        scalar("id", [](const Ref p) { return p.id(); }),
        vector_field<dim>("reference",
                          [](const Ref p) { return p.reference(); }),
        tensor_field<dim>("F",
                          entries_of_F<dim>(),
                          [](const Ref p, double *values) {
                            for (unsigned int k = 0; k < Layout::n_F; ++k)
                              values[k] = p[Layout::F + k];
                          }),
        tensor_field<dim>("strain",
                          symmetric_entries<dim>("strain"),
                          write_strain<dim>),
        scalar("mass", [](const Ref p) { return p.mass(); }),
        scalar("volume", [](const Ref p) { return p.volume(); }),
        scalar_field<dim>(
          "size",
          [](const Ref p, const Body<dim> &body, const unsigned int) {
            return p.extent(body.points.layout());
          }),
        scalar_field<dim>(
          "pore_pressure",
          [](const Ref p, const Body<dim> &body, const unsigned int) {
            return value_of(p, body, "pore_pressure");
          }),
        scalar("process", [process](const Ref) { return process; }),
        scalar_field<dim>(
          "level",
          [](const Ref p, const Body<dim> &body, const unsigned int) -> double {
            const auto *levels = body.points.space().hierarchy();
            return levels ? levels->level(levels->find(
                              p.basis_position(body.points.layout())))
                          : 0;
          })};
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  symmetric_entries(const std::string &name)
  {
    std::vector<std::string> result;
    for (const std::string entry : {"_xx", "_yy", "_zz", "_xy", "_xz", "_yz"})
      result.push_back(name + entry);
    result.resize(PointLayout<dim>::n_stress);
    return result;
  }



  template <int dim>
  std::vector<std::string>
  entries_of_F()
  {
    if (dim == 2)
      return {"F_xx", "F_xy", "F_yx", "F_yy", "F_zz"};
    return {
      "F_xx", "F_xy", "F_xz", "F_yx", "F_yy", "F_yz", "F_zx", "F_zy", "F_zz"};
  }



  template <int dim>
  std::vector<OutputField<dim>>
  point_fields(const std::vector<std::string> &names,
               const BodyList<dim>            &bodies,
               const unsigned int              process)
  {
    std::vector<OutputField<dim>> result;
    for (const OutputField<dim> &field : all_fields<dim>(process))
      if (contains(names, field.name))
        result.push_back(field);
    if (contains(names, "history"))
      add_history(result, bodies);
    return result;
  }



  std::string
  output_field_names()
  {
    std::string result;
    for (const auto &field : all_fields<2>(0))
      result += field.name + "|";
    return result + "history|stress_jump|acceleration|force|cell_class";
  }



  GREVILLE_INSTANTIATE(symmetric_entries);
  GREVILLE_INSTANTIATE(entries_of_F);
  GREVILLE_INSTANTIATE(point_fields);
} // namespace greville

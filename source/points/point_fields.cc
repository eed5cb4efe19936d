// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/point_fields.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr const char *axes[] = {"x", "y", "z"};



    /**
     * Return the components of a symmetric tensor, in the order of PointLayout.
     */
    template <int dim>
    std::vector<std::string>
    symmetric(const std::string &name)
    {
      std::vector<std::string> result(PointLayout<dim>::n_stress);
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j)
          if (dim == 3 || i == j || j < 2)
            result[PointLayout<dim>::stress_index(i, j)] =
              name + "_" + axes[i] + axes[j];
      return result;
    }



    template <int dim>
    std::vector<std::string>
    components_of_F()
    {
      std::vector<std::string> result(PointLayout<dim>::n_F);
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          if (dim == 3 || (i < 2 && j < 2) || (i == 2 && j == 2))
            result[PointLayout<dim>::F_index(i, j)] =
              std::string("F_") + axes[i] + axes[j];
      return result;
    }



    double
    mean_pressure(const SymmetricTensor<2, 3> &stress)
    {
      return -trace(stress) / 3.;
    }



    template <int dim>
    void
    add_history(std::vector<OutputField<dim>> &fields,
                const BodyList<dim>           &bodies)
    {
      std::vector<std::string> names;
      for (const Body<dim> &body : bodies)
        for (const std::string &name : body.material->state_names())
          if (std::find(names.begin(), names.end(), name) == names.end())
            names.push_back(name);
      for (const std::string &name : names)
        fields.push_back({"history",
                          {name},
                          false,
                          [name](const ConstPointRef<dim> p,
                                 const Body<dim>         &body,
                                 const unsigned int,
                                 double *values) {
                            const PointField *field =
                              body.points.layout().find(name);
                            values[0] = field ? p[field->first] : 0.;
                          }});
    }



    /// Return all fields except the history.
    template <int dim>
    std::vector<OutputField<dim>>
    all_fields(const unsigned int process)
    {
      using Layout = PointLayout<dim>;
      using Ref    = ConstPointRef<dim>;
      std::vector<OutputField<dim>> fields;

      const auto add_vector = [&](const std::string &name, const auto &value) {
        fields.push_back({name,
                          std::vector<std::string>(dim, name),
                          true,
                          [value](const Ref p,
                                  const Body<dim> &,
                                  const unsigned int,
                                  double *values) {
                            const Tensor<1, dim> vector = value(p);
                            for (unsigned int d = 0; d < dim; ++d)
                              values[d] = vector[d];
                          }});
      };
      const auto add_scalar = [&](const std::string &name, const auto &value) {
        fields.push_back(
          {name,
           {name},
           false,
           [value](const Ref p,
                   const Body<dim> &,
                   const unsigned int b,
                   double            *values) { values[0] = value(p, b); }});
      };
      const auto add_tensor = [&](const std::string              &name,
                                  const std::vector<std::string> &components,
                                  const auto                     &write) {
        fields.push_back({name,
                          components,
                          false,
                          [write](const Ref p,
                                  const Body<dim> &,
                                  const unsigned int,
                                  double *values) { write(p, values); }});
      };

      add_vector("velocity", [](const Ref p) { return p.velocity(); });
      add_vector("displacement",
                 [](const Ref p) { return p.position() - p.reference(); });
      add_tensor("stress",
                 symmetric<dim>("stress"),
                 [](const Ref p, double *values) {
                   for (unsigned int k = 0; k < Layout::n_stress; ++k)
                     values[k] = p.stress(k);
                 });
      add_scalar("pressure", [](const Ref p, const unsigned int) {
        return mean_pressure(p.stress());
      });
      add_scalar("von_mises", [](const Ref p, const unsigned int) {
        return std::sqrt(1.5) * deviator(p.stress()).norm();
      });
      add_scalar("J", [](const Ref p, const unsigned int) { return p.J(); });
      add_scalar("density", [](const Ref p, const unsigned int) {
        return p.mass() / p.volume();
      });
      add_scalar("body", [](const Ref, const unsigned int b) { return b; });
      add_scalar("id", [](const Ref p, const unsigned int) { return p.id(); });
      add_vector("reference", [](const Ref p) { return p.reference(); });
      add_tensor("F", components_of_F<dim>(), [](const Ref p, double *values) {
        for (unsigned int k = 0; k < Layout::n_F; ++k)
          values[k] = p[Layout::F + k];
      });
      add_tensor("strain",
                 symmetric<dim>("strain"),
                 [](const Ref p, double *values) {
                   const Tensor<2, 3> F = p.F();
                   const Tensor<2, 3> E =
                     0.5 * (transpose(F) * F - unit_symmetric_tensor<3>());
                   for (unsigned int i = 0; i < 3; ++i)
                     for (unsigned int j = i; j < 3; ++j)
                       if (dim == 3 || i == j || j < 2)
                         values[Layout::stress_index(i, j)] = E[i][j];
                 });
      add_scalar("mass",
                 [](const Ref p, const unsigned int) { return p.mass(); });
      add_scalar("volume",
                 [](const Ref p, const unsigned int) { return p.volume(); });
      fields.push_back(
        {"size",
         {"size"},
         false,
         [](const Ref        p,
            const Body<dim> &body,
            const unsigned int,
            double *values) { values[0] = p.extent(body.points.layout()); }});
      fields.push_back({"pore_pressure",
                        {"pore_pressure"},
                        false,
                        [](const Ref        p,
                           const Body<dim> &body,
                           const unsigned int,
                           double *values) {
                          const PointField *field =
                            body.points.layout().find("pore_pressure");
                          values[0] = field ? p[field->first] : 0.;
                        }});
      add_scalar("process",
                 [process](const Ref, const unsigned int) { return process; });
      return fields;
    }
  } // namespace



  template <int dim>
  std::vector<OutputField<dim>>
  point_fields(const std::vector<std::string> &names,
               const BodyList<dim>            &bodies,
               const unsigned int              process)
  {
    std::vector<OutputField<dim>> result;
    for (const OutputField<dim> &field : all_fields<dim>(process))
      if (std::find(names.begin(), names.end(), field.name) != names.end())
        result.push_back(field);
    if (std::find(names.begin(), names.end(), "history") != names.end())
      add_history(result, bodies);
    return result;
  }



  std::string
  output_field_names()
  {
    std::string result;
    for (const auto &field : all_fields<2>(0))
      result += field.name + "|";
    return result + "history|acceleration|force|cell_class";
  }



  template decltype(point_fields<2>) point_fields<2>;
  template decltype(point_fields<3>) point_fields<3>;
} // namespace greville

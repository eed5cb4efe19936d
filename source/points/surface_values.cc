// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/surface_values.h>

#include "gradients.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    template <int dim, int n>
    void
    add_values_of(const MaterialPoints<dim>       &points,
                  const SpacePolynomials<dim>     &tables,
                  const std::vector<unsigned int> &parents,
                  const std::vector<double>       &buffer,
                  std::vector<double>             &result)
    {
      const PointLayout<dim> &layout = points.layout();
      const PointField *const radius = layout.find("radius");
      for (const unsigned int cell : points.cells())
        {
          const CellGeometry<dim, n> geometry(tables, parents[cell]);
          points.for_each_in_cell(cell, [&](const ConstPointRef<dim> p) {
            const ValuesAndGradients<dim, n> N(geometry,
                                               p.basis_position(layout));
            double                           value = 0.;
            Tensor<1, dim>                   slope;
            for (int a = 0; a < power(n, dim); ++a)
              {
                const double c = buffer[geometry.functions[a]];
                value += c * N.values[a];
                for (int d = 0; d < dim; ++d)
                  slope[d] += c * N.gradients.values[d][a];
              }
            if (radius)
              value +=
                p[radius->first] * (slope * p.vector(layout.first("normal")));
            result.push_back(value);
          });
        }
    }
  } // namespace



  template <int dim>
  std::vector<std::vector<double>>
  values_at_surfaces(const SpacePolynomials<dim>     &tables,
                     const std::vector<unsigned int> &parents,
                     const VectorType                &coefficients,
                     const std::vector<const MaterialPoints<dim> *> &surfaces)
  {
    const SplineSpace<dim> &space = *tables.space;
    std::vector<double>     buffer(n_local_functions(space));
    put_into_buffer(coefficients, 1, 0, buffer);
    std::vector<std::vector<double>> result(surfaces.size());
    with_order(space.degree(), [&](const auto size) {
      for (unsigned int s = 0; s < surfaces.size(); ++s)
        add_values_of<dim, decltype(size)::value>(
          *surfaces[s], tables, parents, buffer, result[s]);
    });
    return result;
  }



  GREVILLE_INSTANTIATE(values_at_surfaces);
} // namespace greville

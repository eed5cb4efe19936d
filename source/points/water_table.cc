// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/points/water_table.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  WaterTable<dim>::WaterTable(const std::string    &table,
                              const double          density,
                              const double          suction,
                              const Tensor<1, dim> &gravity)
    : suction(suction)
  {
    if (table.empty())
      return;
    axis = dim;
    for (unsigned int d = 0; d < dim; ++d)
      if (std::abs(gravity[d]) > 0.999 * gravity.norm())
        axis = d;
    Require(axis < dim && gravity.norm() > 0.,
            "The parameter 'Water/Table' needs a gravity along an axis, but "
            "'Loads/Gravity' is (" +
              text_of(gravity) + ") m / s^2 at the start.");
    weight = -density * gravity[axis];
    height.emplace(table, "Water/Table", coordinate_names<dim>());
  }



  template <int dim>
  double
  WaterTable<dim>::operator()(const Point<dim> &x) const
  {
    if (!height)
      return 0.;
    const double p = weight * ((*height)(x)[0] - x[axis]);
    return suction > 0. ? std::max(p, -suction) : p;
  }



  GREVILLE_INSTANTIATE_CLASS(WaterTable);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_soil_layers_h
#define greville_points_soil_layers_h

#include <greville/points/body.h>
#include <greville/points/water_table.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * A body with K0, whose weight lies on those below.
   */
  struct SoilLayer
  {
    std::string name; // of the body
    std::string surface, shape;
    double      density = 0.; // kg / m^3
  };

  /**
   * make_points() of a body below @p layers: the vertical stress of its K0
   * procedure, Pa, is
   *   rho g (s - y) + sum_i rho_i g (s_i - s_(i-1)),
   * with its own 'Surface' s at the place, and above it the surfaces s_i of the
   * layers, from below, that are there: a layer is where its 'Shape' has the
   * middle between s_(i-1) and s_i. The body may be among the layers.
   *
   * Below a water @p table the pressure p of water at rest is subtracted, and
   * that of water above the highest surface added: the stress is the effective
   * one. Points with a field "pore_pressure" keep p.
   */
  template <int dim>
  std::vector<unsigned int>
  make_points(Body<dim>                    &body,
              const SplineSpace<dim>       &space,
              const dealii::Tensor<1, dim> &gravity,
              const PointLayout<dim>       &layout,
              const std::vector<SoilLayer> &layers,
              const WaterTable<dim>        &table = {});
} // namespace greville

#endif

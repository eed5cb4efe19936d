// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_soil_layers_h
#define greville_points_soil_layers_h

#include <greville/points/body.h>
#include <greville/points/water_table.h>

#include <string>
#include <vector>

namespace greville
{
  /// A body with a K0 stress, whose weight acts on the bodies below.
  struct SoilLayer
  {
    std::string name; // of the body
    std::string surface, shape;
    double      density = 0.; // kg / m^3
  };

  /**
   * Call make_points() for a body below @p layers: the vertical stress of its
   * K0 procedure, Pa, is
   *   rho g (s - y) + sum_i rho_i g (s_i - s_(i-1)),
   * with its own 'Surface' s at the place and the surfaces s_i of the layers
   * above it, from below. A layer is present at a place if its 'Shape' contains
   * the middle between s_(i-1) and s_i. The body may be among the layers.
   *
   * Below a water @p table, the pressure p of water at rest is subtracted, and
   * the pressure of water above the highest surface is added: the result is the
   * effective stress. Points with a field "pore_pressure" store p.
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

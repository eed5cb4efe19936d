// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>

#include <greville/geometry/placement.h>
#include <greville/materials/material.h>
#include <greville/points/material_points.h>
#include <greville/points/water_table.h>

#include <string>
#include <vector>

namespace greville
{
  /// Parameters of a body: the initial positions, velocity and stress of its
  /// points.
  struct BodyParameters : PointPlacement
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string material;
    std::string points_file;
    std::string displacement;
    std::string velocity;
    std::string stress;
    double      K0 = -1.;
    std::string surface;
  };



  /// A body: its material and its points on this process.
  template <int dim>
  struct Body
  {
    std::string           name;
    const BodyParameters *parameters = nullptr;
    const Material       *material   = nullptr;
    MaterialPoints<dim>   points;
    /// The number of points on all processes, including points that have left
    /// the grid; 0 if the body is absent.
    std::uint64_t n_points = 0;
  };



  /// A body with a K0 stress, whose weight acts on the bodies below.
  struct SoilLayer
  {
    std::string name; // of the body
    std::string surface, shape;
    double      density = 0.; // kg / m^3
  };



  /**
   * Collective. Make the points of @p body on the cells of @p space. Its name,
   * parameters and material must be set; @p layout contains the history
   * variables of the material. Throws dealii::ExcMessage for a body that is
   * empty or extends beyond the grid, and for invalid formulas, files and
   * stresses.
   *
   * Points and ids do not depend on the number of processes. Points with an
   * initial displacement are still stored in the cells of their original
   * positions. Returns the cells that such points must leave.
   *
   * The vertical stress of the K0 procedure, Pa, is with @p gravity g (m / s^2)
   *   rho g (s - y) + sum_i rho_i g (s_i - s_(i-1)),
   * with the body's 'Surface' s at the position x and the surfaces s_i of the
   * @p layers above it, in ascending order. A layer is present at x if its
   * 'Shape' contains the middle between s_(i-1) and s_i. The body may be among
   * the layers. Below a water @p table, the pressure p of water at rest is
   * subtracted, and the pressure of water above the highest surface is added,
   * which gives the effective stress. Points with a field "pore_pressure" store
   * p.
   */
  template <int dim>
  std::vector<unsigned int>
  make_points(Body<dim>                    &body,
              const SplineSpace<dim>       &space,
              const dealii::Tensor<1, dim> &gravity,
              const PointLayout<dim>       &layout,
              const std::vector<SoilLayer> &layers = {},
              const WaterTable<dim>        &table  = {});
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_body_h
#define greville_points_body_h

#include <deal.II/base/parameter_handler.h>

#include <greville/geometry/placement.h>
#include <greville/materials/material.h>
#include <greville/points/material_points.h>

#include <string>

namespace greville
{
  /**
   * Parameters of a body: the initial positions, velocity and stress of its
   * points.
   */
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



  /**
   * A body: its material and its points on this process.
   */
  template <int dim>
  struct Body
  {
    std::string           name;
    const BodyParameters *parameters = nullptr;
    const Material       *material   = nullptr;
    MaterialPoints<dim>   points;
    /**
     * The number of points on all processes, including points that have left
     * the grid; 0 if the body is absent.
     */
    std::uint64_t n_points = 0;
  };



  /**
   * Collective. Make the points of @p body on the cells of @p space. Its name,
   * parameters and material must be set; @p layout contains the history
   * variables of the material. @p gravity (m / s^2) is used in the K0
   * procedure. Throws dealii::ExcMessage for a body that is empty or extends
   * beyond the grid, and for invalid formulas, files and stresses.
   *
   * Points and ids do not depend on the number of processes. Points with an
   * initial displacement are still stored in the cells of their original
   * positions; the cells that points must leave are returned.
   */
  template <int dim>
  std::vector<unsigned int>
  make_points(Body<dim>                    &body,
              const SplineSpace<dim>       &space,
              const dealii::Tensor<1, dim> &gravity,
              const PointLayout<dim>       &layout);
} // namespace greville

#endif

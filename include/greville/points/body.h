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
   * Parameters of a body: where its points are initially, their velocity and
   * stress.
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
    /// Number of points of all processes, with those that have left the grid.
    /// 0: the body is not there.
    std::uint64_t n_points = 0;
  };



  /**
   * Collective. Make the points of @p body on the cells of @p space. Its name,
   * parameters and material are set; @p layout has the history variables of
   * the material. @p gravity (m / s^2) is that of the K0
   * procedure. Throws dealii::ExcMessage for a body that is empty or sticks out
   * of the grid, for wrong formulas, files and stresses.
   *
   * The points, and their ids, do not depend on the number of processes. Where
   * they have an initial displacement, they still lie in the cells of
   * their positions before: returns the cells that points have to leave.
   */
  template <int dim>
  std::vector<unsigned int>
  make_points(Body<dim>                    &body,
              const SplineSpace<dim>       &space,
              const dealii::Tensor<1, dim> &gravity,
              const PointLayout<dim>       &layout);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_body_h
#define greville_points_body_h

#include <deal.II/base/parameter_handler.h>

#include <greville/base/expression.h>
#include <greville/geometry/placement.h>
#include <greville/materials/material.h>
#include <greville/points/material_points.h>

#include <memory>
#include <optional>
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
    std::string imposed_velocity;
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
    /// Number of points of all processes.
    std::uint64_t n_points = 0;
    /// The imposed velocity of a rigid body (m / s, of t): all of its points
    /// have it, whatever acts on them. Others meet it by Obstacles.
    std::optional<VectorExpression<dim>> rigid_motion;
  };



  /**
   * Pointers to the @p bodies that are rigid, or to those that are not, in
   * their order.
   */
  template <typename Bodies>
  auto
  select_bodies(Bodies &bodies, const bool rigid)
  {
    std::vector<decltype(&bodies[0])> result;
    for (auto &body : bodies)
      if (body.rigid_motion.has_value() == rigid)
        result.push_back(&body);
    return result;
  }

  template <typename Bodies>
  auto
  rigid_bodies(Bodies &bodies)
  {
    return select_bodies(bodies, true);
  }

  template <typename Bodies>
  auto
  deformable_bodies(Bodies &bodies)
  {
    return select_bodies(bodies, false);
  }



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

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>

#include <limits>

namespace greville
{
  /// The state of contact at a point: open, sticking or sliding. Without
  /// friction, all closed points slide.
  enum class ContactState : unsigned char
  {
    open  = 0,
    stick = 1,
    slip  = 2
  };



  /// A point of a surface in a contact of two sides, which are numbered 0 and
  /// 1.
  template <int dim>
  struct ContactPoint
  {
    unsigned int side = 0;
    /// The position, and the outward unit normal. The normal of a material
    /// point is zero: it faces all surfaces nearby.
    dealii::Point<dim>     x;
    dealii::Tensor<1, dim> normal;
    /// For a material point, the distance to the surface ahead of it, m;
    /// otherwise 0.
    double radius = 0.;
    /// The current area, m^2 (in 2D m, in axisymmetry m^2 per radian), and the
    /// area divided by the length in the plane: the distance from the axis in
    /// axisymmetry, m, otherwise 1.
    double area      = 0.;
    double thickness = 1.;
    /// The size of the cells at the point, m, to which distances of searches
    /// refer. Unlike positions, it does not change in trial steps.
    double cell_size = 1.;
    /// The displacement in the step, m.
    dealii::Tensor<1, dim> motion;
    /// The vector from the place at which hat functions are evaluated to x, m.
    /// The place is half way to the other side, so that two parallel surfaces
    /// have the same weights, and is frozen during trial steps of implicit
    /// schemes: the energy balance of implicit midpoint steps depends on both.
    dealii::Tensor<1, dim> offset_from_hats;
    /// The elastic part of the slip of side 0 along side 1, m: history.
    dealii::Tensor<1, dim> slip;

    /// The pressure at the start of the step, Pa, see KeyMemory.
    double start_pressure = 0.;
    /// The pressure of the pore water, Pa, which is a part of the contact
    /// pressure; 0 without water.
    double pore_pressure = 0.;

    /// True if the other side is in front of the point, or the point is
    /// slightly inside it.
    bool is_facing = false;
    /// The distance from the other side less the radius, negative inside, m.
    double gap = 0.;
    /// The distance from a rigid body, m, even if the point does not face it.
    double distance = std::numeric_limits<double>::infinity();
    /// The outward normal of the other side at the closest point.
    dealii::Tensor<1, dim> target_normal;
    /// The displacement in the step, m, of the other side's material that is
    /// now at the closest point; for rigid bodies only.
    dealii::Tensor<1, dim> target_motion;

    /// The contact force, N (2D: N / m), and the slip at the end of the step.
    dealii::Tensor<1, dim> force, new_slip;
    /// The state that most of the point's keys under pressure have, by weight.
    ContactState state = ContactState::open;
    /// The stiffness against a common displacement of all points of its side, N
    /// / m (2D: N / m^2), if requested: a scale of round-off.
    dealii::Tensor<2, dim> stiffness;
  };
} // namespace greville

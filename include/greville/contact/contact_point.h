// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_contact_contact_point_h
#define greville_contact_contact_point_h

#include <deal.II/base/point.h>

#include <limits>

namespace greville
{
  /**
   * Whether there is pressure at a point, and whether surfaces slide there.
   * Without friction all that is closed slides.
   */
  enum class ContactState : unsigned char
  {
    open  = 0,
    stick = 1,
    slip  = 2
  };



  /**
   * A point of a surface in a contact of two sides, which are numbered 0 and 1.
   */
  template <int dim>
  struct ContactPoint
  {
    unsigned int side = 0;
    /// Where it is, and the normal there, of length 1, outwards. A material
    /// point has none (0): it faces all that is near.
    dealii::Point<dim>     x;
    dealii::Tensor<1, dim> normal;
    /// How far the surface is in front of a material point, m; otherwise 0.
    double radius = 0.;
    /// The present area, m^2 (in 2D m, in axisymmetry m^2 per radian), and the
    /// area over the length in the plane: the distance from the axis in
    /// axisymmetry, m, otherwise 1.
    double area      = 0.;
    double thickness = 1.;
    /// The displacement in the step, m.
    dealii::Tensor<1, dim> motion;
    /// From where hat functions are evaluated to x, m. That is half way to the
    /// other side, so that two parallel surfaces have the same weights, and
    /// frozen while an implicit step is tried: the energy of implicit midpoint
    /// steps rests on both.
    dealii::Tensor<1, dim> since_hats;
    /// The elastic part of the slip of side 0 along side 1, m: history.
    dealii::Tensor<1, dim> slip;

    /// The pressure at the start of the step, Pa, see KeyMemory.
    double start_pressure = 0.;
    /// That of the water in the pores, Pa, a part of the pressure of contact; 0
    /// without water.
    double pore_pressure = 0.;

    /// Whether the other side is in front of it, or it is a little way inside.
    bool is_facing = false;
    /// The distance from the other side less the radius, negative inside, m.
    double gap = 0.;
    /// The distance from a rigid body, also if it is not in front of it, m.
    double distance = std::numeric_limits<double>::infinity();
    /// The normal of the other side at the closest point, outwards from it.
    dealii::Tensor<1, dim> target_normal;
    /// The displacement in the step of the other side's material that is
    /// the closest point now; of rigid bodies only, m.
    dealii::Tensor<1, dim> target_motion;

    /// What contact gives to it: N (2D: N / m), and the slip after the step.
    dealii::Tensor<1, dim> force, new_slip;
    /// That of the larger part of its keys under pressure.
    ContactState state = ContactState::open;
    /// What resists its own displacement, where all points of its side move
    /// like it, N / m (2D: N / m^2); where it is asked for, see ContactTangent.
    dealii::Tensor<2, dim> stiffness;
  };
} // namespace greville

#endif

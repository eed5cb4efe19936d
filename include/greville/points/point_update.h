// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_points_point_update_h
#define greville_points_point_update_h

#include <greville/base/vector_field.h>
#include <greville/materials/material.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace greville
{
  template <int dim>
  class RowSums;

  template <int dim>
  class VolumeProjection;



  /**
   * How grid_to_points() moves points.
   */
  template <int dim>
  struct PointUpdate
  {
    /// Grid acceleration a: points are kicked if it is given.
    const VectorField<dim> *acceleration = nullptr;
    /// Grid velocity v: points are moved by it if @p move, and PIC and APIC
    /// take it over where points are kicked.
    const VectorField<dim> *velocity = nullptr;
    /// Grid velocity w whose gradient deforms the points, if it is given.
    const VectorField<dim> *deformation = nullptr;
    /// Whether x changes.
    bool move = false;
    /// Steps of time (s) of velocity and of position and deformation.
    double velocity_step = 0.;
    double step          = 0.;
    /// The time at the end of the step, s.
    double time = 0.;
    /// 1: FLIP, 0: PIC.
    double flip = 1.;
    /// APIC: points have an affine matrix.
    bool apic = false;
    /// The projection of the changes of volume, if there is one.
    VolumeProjection<dim> *projection = nullptr;
    /// The law of the points, which gives them a stress where they are
    /// deformed; null: they have none.
    const Material *material = nullptr;
    /// What it says at the end of the step, see Material.
    double strength_reduction = 1.;
    /// What a kick sums up, if it is given: points as they are before, with
    /// velocities that are the part row_fraction of the way from those before
    /// to those after the kick.
    RowSums<dim> *row          = nullptr;
    double        row_fraction = 0.;
  };



  /**
   * Sums and extremes over points after they have been updated, which show
   * whether a step was sound.
   */
  struct PointSums
  {
    /// Of points that have moved: their mass (kg; 2D: kg / m) and momentum, and
    /// the largest part of a cell that one of them has crossed in a direction.
    double                mass     = 0.;
    std::array<double, 3> momentum = {};
    double                crossed  = 0.;
    /// Of points that have been deformed: the extremes of J.
    double smallest_J = std::numeric_limits<double>::max();
    double largest_J  = 0.;

    /**
     * Add those of other points, or of another pass over the same ones.
     */
    void
    add(const PointSums &other)
    {
      mass += other.mass;
      for (unsigned int d = 0; d < momentum.size(); ++d)
        momentum[d] += other.momentum[d];
      crossed    = std::max(crossed, other.crossed);
      smallest_J = std::min(smallest_J, other.smallest_J);
      largest_J  = std::max(largest_J, other.largest_J);
    }
  };



  /**
   * What grid_to_points() found on this process.
   */
  struct PointReport
  {
    /// The largest c + |v| (m / s) with the speed c of pressure waves, and c.
    double    fastest_signal = 0., fastest_wave = 0.;
    PointSums sums;
    /// Cells that at least one point has left.
    std::vector<unsigned int> left_cells;
    /// First point with J <= 0 or NaN in stress or position: id, and reason.
    std::int64_t bad_point = -1;
    std::string  bad_reason;
  };
} // namespace greville

#endif

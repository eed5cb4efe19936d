// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

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



  /// The arguments of an update of points. PointTransfer::grid_to_points()
  /// lists the supported combinations.
  template <int dim>
  struct PointUpdate
  {
    /// Grid acceleration a; if given, it kicks the points.
    const VectorField<dim> *acceleration = nullptr;
    /// Grid velocity v; it moves points if @p move. In a kick, PIC and APIC
    /// points take this velocity, and points of Taylor its gradient.
    const VectorField<dim> *velocity = nullptr;
    /// Grid velocity w; if given, its gradient deforms the points.
    const VectorField<dim> *deformation = nullptr;
    /// True if x changes.
    bool move = false;
    /// Time steps (s) of the velocity, and of position and deformation.
    double velocity_step = 0.;
    double step          = 0.;
    /// The time at the end of the step, s.
    double time = 0.;
    /// 1: FLIP, 0: PIC.
    double flip = 1.;
    /// True for APIC: points have an affine matrix.
    bool apic = false;
    /// True if the affine matrix of points is set to the velocity gradient.
    bool taylor = false;
    /// The projection of volume changes, or null.
    VolumeProjection<dim> *projection = nullptr;
    /// The law for the stress of deformed points; null without stress.
    const Material *material = nullptr;
    /// Material::strength_reduction() at the end of the step.
    double strength_reduction = 1.;
    /// The row that a kick sums up, or null. Points are taken before the kick,
    /// and row_fraction interpolates between the velocities before and after
    /// it.
    RowSums<dim> *row          = nullptr;
    double        row_fraction = 0.;
  };



  /// Sums and extremes over updated points, for checks of a step.
  struct PointSums
  {
    /// For moved points: mass (kg; 2D: kg / m), momentum, and the largest
    /// fraction of a cell crossed in a direction.
    double                mass     = 0.;
    std::array<double, 3> momentum = {};
    double                crossed  = 0.;
    /// For deformed points: the extremes of J.
    double smallest_J = std::numeric_limits<double>::max();
    double largest_J  = 0.;

    /// Add the sums of other points, or of another pass over the same points.
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



  /// The results of grid_to_points() on this process.
  struct PointReport
  {
    /// The largest c + |v| and c, m / s, with the speed c of pressure waves.
    double    fastest_signal = 0., fastest_wave = 0.;
    PointSums sums;
    /// Cells that at least one point has left.
    std::vector<unsigned int> left_cells;
    /// The id of the first point with J <= 0, or with NaN in stress or
    /// position, and the reason.
    std::int64_t bad_point = -1;
    std::string  bad_reason;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/late_row.h>

#include <string>

namespace greville
{
  /// The results of an update of the points of all bodies on this process.
  struct PointMotion
  {
    /// Signals::fastest and Signals::wave, m / s.
    double fastest_signal = 0., fastest_wave = 0.;
    /// Sums over all bodies.
    PointSums sums;
    /// The cells that at least one point has left, by body.
    std::vector<std::vector<unsigned int>> left_cells;
    /// The cells that at least one point of a surface has left, by surface.
    std::vector<std::vector<unsigned int>> left_surface_cells;
    /// A message about an invalid point, empty if there is none.
    std::string problem;

    /// Merge the results of an earlier pass over the same points.
    void
    merge(const PointMotion &before);
  };

  /// Set the velocities of bodies and surfaces to zero.
  template <int dim>
  void
  stop_points(State<dim> &state);

  /// Collective. Update the points of all bodies in one pass. Each body uses
  /// its own material instead of the material of the @p update, with the
  /// strength at the @p time (s) of the points after the step. A kick sums up
  /// the @p row unless null.
  template <int dim>
  PointMotion
  update_points(std::vector<Body<dim>> &bodies,
                PointTransfer<dim>     &transfer,
                PointUpdate<dim>        update,
                const double            time,
                LateRow<dim>           *row = nullptr);

  /// Collective. Update the points of surfaces, which have no inertia: a kick
  /// gives them the velocity of the grid. The result is added to the @p motion.
  template <int dim>
  void
  update_surfaces(std::vector<Surface<dim>> &surfaces,
                  PointTransfer<dim>        &transfer,
                  PointUpdate<dim>           update,
                  PointMotion               &motion);

  /// Collective. Average the volume changes of neighboring points of fluids
  /// every ten steps, slowly compared with a wave that crosses a cell of the
  /// size @p h.
  template <int dim>
  void
  share_volume(State<dim> &state, PointTransfer<dim> &transfer, const double h);
} // namespace greville

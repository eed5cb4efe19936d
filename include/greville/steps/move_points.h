// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_move_points_h
#define greville_steps_move_points_h

#include <greville/parameters/simulation_parameters.h>
#include <greville/steps/late_row.h>
#include <greville/steps/state.h>

#include <string>

namespace greville
{
  /**
   * What came of points of all bodies on this process.
   */
  struct PointMotion
  {
    /// Signals::fastest and Signals::wave, m / s.
    double fastest_signal = 0., fastest_wave = 0.;
    /// Of all bodies.
    PointSums sums;
    /// By body: cells that at least one point has left.
    std::vector<std::vector<unsigned int>> left_cells;
    /// Likewise by surface.
    std::vector<std::vector<unsigned int>> left_surface_cells;
    /// What is wrong with a point, empty if nothing is.
    std::string problem;

    /**
     * Take over what came of the same points before.
     */
    void
    merge(const PointMotion &before);
  };

  /**
   * The share of FLIP in a step @p dt (s), see SchemeParameters: @p h is the
   * smallest edge of a cell, @p signal the fastest initial speed (m / s).
   */
  double
  flip_share(const SchemeParameters &scheme,
             const double            h,
             const double            signal,
             const double            dt);

  /**
   * Set the velocities of bodies and surfaces to zero.
   */
  template <int dim>
  void
  stop_points(State<dim> &state);

  /**
   * Collective. One pass over the points of all bodies, without those that the
   * @p update does not change. Its material is that of each body, with the
   * strength that it has at the @p time (s) to which the points come. A kick
   * sums up the @p row; null: none.
   */
  template <int dim>
  PointMotion
  update_points(std::vector<Body<dim>> &bodies,
                PointTransfer<dim>     &transfer,
                PointUpdate<dim>        update,
                const double            time,
                LateRow<dim>           *row = nullptr);

  /**
   * Collective. Likewise the points of surfaces, which have no inertia: where
   * points are kicked, theirs take the velocity of the grid. The result is
   * added to the @p motion.
   */
  template <int dim>
  void
  update_surfaces(std::vector<Surface<dim>> &surfaces,
                  PointTransfer<dim>        &transfer,
                  PointUpdate<dim>           update,
                  PointMotion               &motion);

  /**
   * Collective. Points of fluids share their changes of volume, every ten steps
   * and slowly against waves that cross a cell of the size @p h.
   */
  template <int dim>
  void
  share_volume(State<dim> &state, PointTransfer<dim> &transfer, const double h);
} // namespace greville

#endif

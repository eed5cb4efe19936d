// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/grid_field.h>
#include <greville/steps/state.h>
#include <greville/steps/statistics.h>

#include <functional>

namespace greville
{
  /**
   * A row of statistics for the time t_n between two explicit steps, which is
   * summed up in the second step. With velocities at half steps, points have
   * v(n - 1/2) before it and v(n + 1/2) after it. At t_n they have
   *   v_n = (1 - f) v(n - 1/2) + f v(n + 1/2),
   * where f is the fraction of the time between the two velocities: 1/2 for
   * equal steps, 0 in the first step. Positions and stresses are taken before
   * the step. The work done by displacements is complete at t_n. The fraction f
   * of the kick acts before t_n and does work on (v(n - 1/2) + v_n) / 2.
   */
  template <int dim>
  struct LateRow
  {
    /// True if the next step must sum up the row; true if the last one did.
    bool is_wanted = false, is_known = false;

    /// The quantities known at t_n; reactions are the share of this process.
    Statistics<dim>        row;
    dealii::Tensor<1, dim> gravity;

    /// f
    double fraction = 0.;
    /// By body.
    std::vector<RowSums<dim>> sums;
    EnergyBalance             energy;
    /// The energy of StepGuard::set_energy_swing().
    double energy_swing = 0.;

    /// A function called before the kick of the points, and again after it,
    /// before they move to other cells, with the weights of their velocities.
    std::function<void(const double weight, const bool is_kicked)> watch;

    /// A function called while the state is at t_n, with the velocities v_n of
    /// points and grid.
    std::function<void()> show;

    /// Return the part of a kick's work that is done until t_n, J (2D: J / m).
    /// @p before is I v(n - 1/2) and @p after is I v(n + 1/2), with the impulse
    /// I.
    double
    part_of_work(const double before, const double after) const
    {
      return fraction *
             ((1. - 0.5 * fraction) * before + 0.5 * fraction * after);
    }
  };



  /// A copy of the point data that a kick changes: velocities, and the fields
  /// stored after the history variables.
  template <int dim>
  class KickedNumbers
  {
  public:
    explicit KickedNumbers(const std::vector<Body<dim>> &bodies);

    /// Set the data of the points, which have not moved since the copy, to
    /// @p weight times the copy plus 1 - @p weight times the present values.
    void
    restore(std::vector<Body<dim>> &bodies, const double weight = 1.) const;

  private:
    std::vector<double> numbers;
  };
} // namespace greville

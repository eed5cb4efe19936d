// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// The cells that indicators want to be halved.
  template <int dim>
  struct RefinementMarks
  {
    std::vector<std::uint64_t> cells; // positions
    /// True if 'Grid/Most cells' leaves out some of them.
    bool is_limited = false;
  };

  /**
   * Collective. Return the cells that the indicators of 'Grid/Refinement' want
   * to be halved, or to remain so, anywhere in the grid. Rings of ceil(p / 2)
   * cells around newly marked cells are marked, too: narrower regions have no
   * smaller functions.
   *
   * The indicator stress jump of a cell is the sum of the squares of
   * StressJumps::of_points over its points, weighted by their volumes. A cell
   * is halved if the sum of StressJumps::developed exceeds the value above
   * which cells have the given share of all jumps. Sums below the square of
   * 1e-3 times the mean stress count as 0.
   */
  template <int dim>
  RefinementMarks<dim>
  mark_cells(State<dim>                 &state,
             Discretization<dim>        &discretization,
             const SimulationParameters &parameters,
             const IsNearSurface<dim>   &is_near);
} // namespace greville

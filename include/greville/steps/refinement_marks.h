// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// The cells that indicators want to be halved.
  template <int dim>
  struct RefinementMarks
  {
    std::vector<MultiIndex<dim>> cells;
    /// True if 'Grid/Most cells' leaves out some of them.
    bool is_limited = false;
  };

  /**
   * Collective. Return the cells that the indicators of 'Grid/Refinement' want
   * to be halved, or to remain so, anywhere in the grid. Rings of ceil(p / 2)
   * cells around newly marked cells are marked, too: narrower regions have no
   * smaller functions.
   *
   * The stress jump of a cell is @f$ \sum_p V_p |\sigma_p - P\sigma(x_p)|^2
   * @f$ over its points, where P is the projection to splines by the mass
   * matrix, @f$ M c = \sum_p m_p N \sigma_p @f$. Values below the square of
   * 1e-3 times the mean stress count as 0.
   */
  template <int dim>
  RefinementMarks<dim>
  mark_cells(State<dim>                 &state,
             Discretization<dim>        &discretization,
             const SimulationParameters &parameters);
} // namespace greville

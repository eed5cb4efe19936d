// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/benchmark/problem_parameters.h>
#include <greville/boundary/constrained_functions.h>

namespace greville
{
  /// Return fixed walls: the walls in 'Problem/Clamped walls', or, if there are
  /// none, @p all walls or else only the lower wall in the last direction.
  template <int dim>
  Walls<dim>
  clamped_walls(const ProblemParameters &parameters, const bool all)
  {
    WallParameters walls;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (parameters.clamped.empty()
            ? all || w == 2 * (dim - 1)
            : contains(parameters.clamped, WallParameters::names[w]))
        walls.type[w] = "fixed";
    return Walls<dim>(walls);
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/boundary/walls.h>

namespace greville
{
  /// Collective. Return the values of all local functions from the values of
  /// owned ones.
  template <int dim>
  std::vector<unsigned char>
  with_ghosts(const SplineSpace<dim>           &space,
              const std::vector<unsigned char> &owned);

  /// Collective. Return 1 for the local functions of a space that walls
  /// constrain in a component, 0 for others.
  template <int dim>
  std::vector<unsigned char>
  constrained_at_walls(const SplineSpace<dim> &space,
                       const Walls<dim>       &walls,
                       const unsigned int      component);



  /// Collective. Return the components (bits) of the local functions of a space
  /// that walls constrain.
  template <int dim>
  std::vector<unsigned char>
  constrained_components_at_walls(const SplineSpace<dim> &space,
                                  const Walls<dim>       &walls);
} // namespace greville

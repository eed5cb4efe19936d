// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_boundary_held_functions_h
#define greville_boundary_held_functions_h

#include <greville/boundary/walls.h>

namespace greville
{
  /**
   * Collective. Values of owned functions, for all local ones.
   */
  template <int dim>
  std::vector<unsigned char>
  with_ghosts(const SplineSpace<dim>           &space,
              const std::vector<unsigned char> &owned);

  /**
   * Collective. The local functions of a space that walls hold in a component:
   * 1, others 0.
   */
  template <int dim>
  std::vector<unsigned char>
  held_at_walls(const SplineSpace<dim> &space,
                const Walls<dim>       &walls,
                const unsigned int      component);



  /**
   * Collective. The components (bits) in which walls hold the local functions
   * of a space.
   */
  template <int dim>
  std::vector<unsigned char>
  held_components_at_walls(const SplineSpace<dim> &space,
                           const Walls<dim>       &walls);
} // namespace greville

#endif

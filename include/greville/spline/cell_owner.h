// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_cell_owner_h
#define greville_spline_cell_owner_h

#include <greville/spline/lattice.h>

namespace greville
{
  /**
   * The process that owns the cell @p index of a triangulation, whose lattice
   * is @p lattice. Not collective: p4est tells where each process begins along
   * its curve, and a search in that takes the logarithm of their number. (What
   * deal.II offers for points, find_point_owner_rank(), looks at all coarse
   * cells for each of them.)
   */
  template <int dim>
  unsigned int
  cell_owner(const DistributedTriangulation<dim> &triangulation,
             const Lattice<dim>                  &lattice,
             const MultiIndex<dim>               &index);
} // namespace greville

#endif

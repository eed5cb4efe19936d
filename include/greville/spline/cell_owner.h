// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/lattice.h>

namespace greville
{
  /// Return the process that owns the cell @p index of a triangulation with the
  /// lattice @p lattice. Not collective: p4est stores where each process starts
  /// along its curve, and the search takes logarithmic time. (deal.II's
  /// find_point_owner_rank() visits all coarse cells for each point.)
  template <int dim>
  unsigned int
  cell_owner(const DistributedTriangulation<dim> &triangulation,
             const Lattice<dim>                  &lattice,
             const MultiIndex<dim>               &index);
} // namespace greville

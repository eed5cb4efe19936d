// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/lattice.h>

#include <string>

namespace greville
{
  /// The coarse cells, or trees of p4est, of a mesh by create_box_mesh() in
  /// each direction, and the number of global refinements.
  template <int dim>
  struct CoarseCells
  {
    CoarseCells(const MultiIndex<dim> &n_cells);

    double
    n_all() const;

    MultiIndex<dim> n;
    unsigned int    n_refinements = 0;
  };



  /// If there are many coarse cells, and more than the cells per process,
  /// return a sentence that says so and proposes numbers of cells with few
  /// coarse cells; otherwise an empty text. Each process stores all coarse
  /// cells.
  template <int dim>
  std::string
  describe_many_coarse_cells(const MultiIndex<dim> &n_cells,
                             const unsigned int     n_processes);
} // namespace greville

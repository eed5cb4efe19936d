// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_coarse_cells_h
#define greville_spline_coarse_cells_h

#include <greville/spline/lattice.h>

#include <string>

namespace greville
{
  /**
   * The coarse cells of a mesh by create_box_mesh(), trees of p4est, in each
   * direction, and how often all of them are refined.
   */
  template <int dim>
  struct CoarseCells
  {
    CoarseCells(const MultiIndex<dim> &n_cells);

    double
    n_all() const;

    MultiIndex<dim> n;
    unsigned int    n_refinements = 0;
  };



  /**
   * Each process keeps all coarse cells, whatever it owns. A sentence about
   * them where they are many and more than the cells that a process has in the
   * mean, with numbers of cells that make few; else nothing.
   */
  template <int dim>
  std::string
  describe_many_coarse_cells(const MultiIndex<dim> &n_cells,
                             const unsigned int     n_processes);
} // namespace greville

#endif

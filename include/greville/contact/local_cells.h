// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/lattice.h>

#include <vector>

namespace greville
{
  /// Return whether all cells of a lattice are equal.
  template <int dim>
  bool
  has_equal_cells(const Lattice<dim> &lattice)
  {
    bool result = !lattice.hierarchy();
    for (unsigned int d = 0; d < dim; ++d)
      result = result && lattice.edges(d).empty();
    return result;
  }



  /// Return the smallest edge of a cell, m.
  template <int dim>
  double
  smallest_edge(const CellBox<dim> &box)
  {
    double h = box.size[0];
    for (unsigned int d = 1; d < dim; ++d)
      h = std::min(h, box.size[d]);
    return h;
  }



  /// Return the smallest edge (m) of the cell of a lattice at a point; of the
  /// nearest cell for points outside.
  template <int dim>
  double
  cell_size_at(const Lattice<dim> &lattice, const dealii::Point<dim> &x)
  {
    return has_equal_cells(lattice)
             ? lattice.smallest_cell_size()
             : smallest_edge(lattice.box(lattice.find_cell(x)));
  }



  /// Return the number of the lattice with the largest cells at a point, among
  /// the lattices that contain it; 0 if there is none.
  template <int dim>
  unsigned int
  lattice_at(const std::vector<Lattice<dim>> &lattices,
             const dealii::Point<dim>        &x)
  {
    constexpr double round_off = 1e-6;
    unsigned int     result    = 0;
    double           largest   = 0.;
    for (unsigned int k = 0; k < lattices.size() && lattices.size() > 1; ++k)
      {
        bool is_inside = true;
        for (unsigned int d = 0; d < dim; ++d)
          is_inside = is_inside && x[d] >= lattices[k].lower()[d] &&
                      x[d] <= lattices[k].upper()[d];
        if (!is_inside)
          continue;
        const double h = cell_size_at(lattices[k], x);
        if (h > (1. + round_off) * largest)
          {
            largest = h;
            result  = k;
          }
      }
    return result;
  }
} // namespace greville

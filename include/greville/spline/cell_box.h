// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace greville
{
  /// Integer coordinates of a cell or a function in a tensor product.
  template <int dim>
  using MultiIndex = std::array<unsigned int, dim>;

  /// Return the position of @p index in lexicographic order, x fastest, in an
  /// array of extents[0] x extents[1] (x extents[2]) entries.
  template <int dim>
  std::uint64_t
  lexicographic(const MultiIndex<dim> &index, const MultiIndex<dim> &extents)
  {
    std::uint64_t result = 0;
    for (int d = dim - 1; d >= 0; --d)
      result = result * extents[d] + index[d];
    return result;
  }

  /// Return the inverse of lexicographic().
  template <int dim>
  MultiIndex<dim>
  multi_index(std::uint64_t position, const MultiIndex<dim> &extents)
  {
    MultiIndex<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        result[d] = position % extents[d];
        position /= extents[d];
      }
    return result;
  }

  /// The place and the size of a cell. Lengths carry the unit of the mesh.
  template <int dim>
  struct CellBox
  {
    /// Number of the cell in each direction, as KnotVector counts elements.
    MultiIndex<dim>        index;
    dealii::Point<dim>     lower, center;
    dealii::Tensor<1, dim> size;

    double
    volume() const
    {
      double result = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        result *= size[d];
      return result;
    }
  };



  /// The edges between the cells of a box in each direction, ascending, with
  /// both ends; none in a direction of equal cells. Lengths carry the unit of
  /// the mesh.
  template <int dim>
  using CellEdges = std::array<std::vector<double>, dim>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>

#include <greville/base/compatibility.h>

#include <algorithm>
#include <array>
#include <cstdint>

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

  /// Where a cell lies. Lengths carry the unit of the mesh.
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



  /// The cells of a box mesh, counted by integers along each axis. The lattice
  /// is read off a triangulation whose active cells are equal boxes that fill a
  /// larger box; it needs no memory besides these few numbers. A direction is
  /// periodic if it is periodic in the triangulation. Lengths carry the unit of
  /// the mesh.
  template <int dim>
  class Lattice
  {
  public:
    Lattice() = default;

    /// Collective. Throws dealii::ExcMessage if @p triangulation is not a box
    /// of equal cells.
    Lattice(const DistributedTriangulation<dim> &triangulation);

    /// Return the lattice of cells of twice the size, each of which joins 2^dim
    /// cells. Throws dealii::ExcMessage for an odd number of cells in a
    /// direction.
    Lattice
    parents() const;

    const MultiIndex<dim> &
    n_cells() const
    {
      return cells;
    }

    bool
    is_periodic(const unsigned int d) const
    {
      return periodic[d];
    }

    bool
    is_periodic() const
    {
      return std::find(periodic.begin(), periodic.end(), true) !=
             periodic.end();
    }

    /// Shift the index of a cell by a period into the lattice in periodic
    /// directions. Returns whether the cell is in the lattice.
    bool
    wrap(MultiIndex<dim> &index) const
    {
      bool is_inside = true;
      for (unsigned int d = 0; d < dim; ++d)
        if (index[d] >= cells[d])
          {
            // An index before the first cell has wrapped to a large number.
            if (periodic[d])
              index[d] += int(index[d]) < 0 ? cells[d] : -cells[d];
            is_inside = is_inside && index[d] < cells[d];
          }
      return is_inside;
    }

    /// Return the number of cells from one cell to another in a direction,
    /// along the shorter way if it is periodic.
    int
    steps(const unsigned int from,
          const unsigned int to,
          const unsigned int d) const
    {
      const int n      = cells[d];
      const int result = int(to) - int(from);
      if (!periodic[d])
        return result;
      return 2 * result > n     ? result - n
             : 2 * result <= -n ? result + n
                                : result;
    }

    const dealii::Point<dim> &
    lower() const
    {
      return lower_corner;
    }

    const dealii::Point<dim> &
    upper() const
    {
      return upper_corner;
    }

    double
    cell_size(const unsigned int d) const
    {
      return sizes[d];
    }

    double
    smallest_cell_size() const
    {
      double h = cell_size(0);
      for (unsigned int d = 1; d < dim; ++d)
        h = std::min(h, cell_size(d));
      return h;
    }

    CellBox<dim>
    box(const MultiIndex<dim> &index) const
    {
      CellBox<dim> result;
      result.index = index;
      for (unsigned int d = 0; d < dim; ++d)
        {
          result.size[d]   = sizes[d];
          result.lower[d]  = lower_corner[d] + sizes[d] * index[d];
          result.center[d] = lower_corner[d] + sizes[d] * (index[d] + 0.5);
        }
      return result;
    }

    /// Return the cell that contains @p point; the nearest one for points
    /// outside.
    MultiIndex<dim>
    find_cell(const dealii::Point<dim> &point) const;

  private:
    void
    set_sizes();

    dealii::Point<dim>     lower_corner;
    dealii::Point<dim>     upper_corner;
    dealii::Tensor<1, dim> sizes;
    MultiIndex<dim>        cells{};
    std::array<bool, dim>  periodic{};
  };

  /// Fill @p triangulation with n_cells[0] x n_cells[1] (x n_cells[2]) equal
  /// cells. The number of p4est's trees, which deal.II keeps on every process,
  /// is the smallest that these numbers allow: the numbers of cells divided by
  /// their largest common power of two. In @p periodic directions the cells at
  /// both ends are neighbours.
  template <int dim>
  void
  create_box_mesh(DistributedTriangulation<dim> &triangulation,
                  const dealii::Point<dim>      &lower,
                  const dealii::Point<dim>      &upper,
                  const MultiIndex<dim>         &n_cells,
                  const std::array<bool, dim>   &periodic = {});

  /// The settings required of a triangulation for a SplineSpace, which asks
  /// p4est for the owners of points.
  template <int dim>
  constexpr typename DistributedTriangulation<dim>::Settings mesh_settings =
    DistributedTriangulation<dim>::communicate_vertices_to_p4est;
} // namespace greville

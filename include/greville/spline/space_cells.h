// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/lattice.h>

#include <vector>

namespace greville
{
  /**
   * The cells of a spline space: all cells of the grid by position, and the
   * cells of this process by number.
   *
   * They are the cells of the triangulation or their *parents*, the cells of
   * the mesh coarsened once. The children of a parent are on one process,
   * because deal.II partitions a mesh so that it can be coarsened.
   */
  template <int dim>
  class SpaceCells
  {
  public:
    using CellIterator =
      typename dealii::Triangulation<dim>::active_cell_iterator;

    /// Collective. Find the owned cells. Throws dealii::ExcMessage for a mesh
    /// that is not a Lattice, and for parents of an odd number of cells.
    void
    reinit(DistributedTriangulation<dim> &triangulation, const bool on_parents);

    const DistributedTriangulation<dim> &
    triangulation() const
    {
      return *tria;
    }

    MPI_Comm
    communicator() const
    {
      return comm;
    }

    /// Return the cells as one lattice, for parts that keep it, compare those
    /// of several grids, or loop over all cells. All other code uses the
    /// functions below.
    const Lattice<dim> &
    lattice() const
    {
      return mesh_lattice;
    }

    /// Return the levels of a refined grid; null for other grids.
    const CellHierarchy<dim> *
    hierarchy() const
    {
      return mesh_lattice.hierarchy();
    }

    /// Return the number of levels up to the last one with cells.
    unsigned int
    n_used_levels() const;

    const MultiIndex<dim> &
    cells_per_direction() const
    {
      return mesh_lattice.n_cells();
    }

    bool
    is_periodic(const unsigned int d) const
    {
      return mesh_lattice.is_periodic(d);
    }

    const dealii::Point<dim> &
    lower_corner() const
    {
      return mesh_lattice.lower();
    }

    const dealii::Point<dim> &
    upper_corner() const
    {
      return mesh_lattice.upper();
    }

    /// Return whether a cell, by its index in a direction, lies at a side of
    /// the grid: 2 d at the lower and 2 d + 1 at the upper end of direction d.
    bool
    is_at_side(const unsigned int index, const unsigned int side) const
    {
      return side % 2 == 0 ? mesh_lattice.is_first(side / 2, index)
                           : mesh_lattice.is_last(side / 2, index);
    }

    /// The size of the smallest cells in a direction.
    double
    cell_size(const unsigned int d) const
    {
      return mesh_lattice.cell_size(d);
    }

    /// Return the size of a cell, by its index in a direction.
    double
    cell_size(const unsigned int d, const unsigned int index) const
    {
      return mesh_lattice.cell_size(d, index);
    }

    /// Return the lower edge of a cell, by its index in a direction, and behind
    /// the last cell its upper one.
    double
    edge(const unsigned int d, const unsigned int index) const
    {
      return mesh_lattice.edge(d, index);
    }

    /// Return the size of the largest cells in a direction.
    double
    largest_cell_size(const unsigned int d) const
    {
      return mesh_lattice.largest_cell_size(d);
    }

    double
    smallest_cell_size() const
    {
      return mesh_lattice.smallest_cell_size();
    }

    /// Return whether all cells have the same size.
    bool
    is_uniform() const
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (!mesh_lattice.edges(d).empty())
          return false;
      return true;
    }

    /// Return the smallest size among a cell, by its index in a direction, and
    /// its two neighbours.
    double
    smallest_near(const unsigned int d, const unsigned int index) const
    {
      return mesh_lattice.smallest_near(d, index);
    }

    /// Lexicographic positions (in cells_per_direction()) of the owned cells,
    /// ascending.
    const std::vector<std::uint64_t> &
    owned_cells() const
    {
      return cells;
    }

    /// Return the place in owned_cells() of a locally owned cell or of its
    /// parent.
    unsigned int
    cell_number(const CellIterator &cell) const;

    /// Return where owned cell number @p cell lies. Costs a few operations.
    CellBox<dim>
    box(const unsigned int cell) const
    {
      return mesh_lattice.box(
        multi_index<dim>(cells[cell], mesh_lattice.n_cells()));
    }

    /// Return the cell that contains a point, anywhere in the mesh; the nearest
    /// cell for points outside.
    CellBox<dim>
    box_around(const dealii::Point<dim> &x) const
    {
      return mesh_lattice.box(mesh_lattice.find_cell(x));
    }

    /// Return whether a point lies in the half-open box of an owned cell, or at
    /// the upper walls of the grid in the closed one. False for NaN.
    bool
    contains(const unsigned int cell, const dealii::Point<dim> &x) const;

    /// Return the position of the cell that contains a point, anywhere in the
    /// mesh; of the nearest cell for points outside.
    std::uint64_t
    cell_position(const dealii::Point<dim> &x) const
    {
      return lexicographic<dim>(mesh_lattice.find_cell(x),
                                mesh_lattice.n_cells());
    }

    /// Return the number of the owned cell at a position, or
    /// invalid_unsigned_int if another process owns the cell.
    unsigned int
    find(const std::uint64_t position) const;

    /// Return the number of the owned cell that contains a point, as
    /// cell_position() and the other find() do.
    unsigned int
    find(const dealii::Point<dim> &x) const
    {
      return find(cell_position(x));
    }

    /// Return the process that owns the cell at a position.
    unsigned int
    owner(const std::uint64_t position) const;

  protected:
    DistributedTriangulation<dim> *tria        = nullptr;
    MPI_Comm                       comm        = MPI_COMM_NULL;
    bool                           has_parents = false;
    Lattice<dim>                   children; // of the mesh
    Lattice<dim>                   mesh_lattice;
    std::vector<std::uint64_t>     cells;
    std::vector<unsigned int>      cell_numbers; // active index
  };
} // namespace greville

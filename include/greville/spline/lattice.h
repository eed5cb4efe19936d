// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/cell_hierarchy.h>

#include <algorithm>

namespace greville
{
  /// The cells of a box mesh, counted by integers along each axis: equal cells,
  /// or in some directions cells between given edges. The lattice is found from
  /// a triangulation, which is made by create_box_mesh(), or whose active cells
  /// are equal boxes that fill a larger box. A direction is periodic if it is
  /// periodic in the triangulation. Lengths carry the unit of the mesh.
  ///
  /// The lattice of a refined mesh contains the cells of all levels of its
  /// CellHierarchy, with its indices.
  template <int dim>
  class Lattice
  {
  public:
    Lattice() = default;

    /// Make a lattice of one cell; place() counts further cells of this size.
    Lattice(const dealii::Point<dim>     &lower,
            const dealii::Tensor<1, dim> &size);

    /// Collective. Throws dealii::ExcMessage if @p triangulation is not such a
    /// mesh.
    Lattice(const DistributedTriangulation<dim> &triangulation);

    /// Return the lattice of cells each of which joins 2^dim cells. Throws
    /// dealii::ExcMessage for an odd number of cells in a direction.
    Lattice
    parents() const;

    const MultiIndex<dim> &
    n_cells() const
    {
      return cells;
    }

    /// Return the levels of a refined mesh; null for other meshes.
    const CellHierarchy<dim> *
    hierarchy() const
    {
      return levels.get();
    }

    /// Return whether the upper end of a cell is the upper end of the lattice.
    bool
    is_last(const unsigned int d, const unsigned int cell) const
    {
      return levels ? edges(d)[cell + 1] == upper_corner[d]
                    : cell + 1 == cells[d];
    }

    /// Return whether the lower end of a cell is the lower end of the lattice.
    bool
    is_first(const unsigned int d, const unsigned int cell) const
    {
      return levels ? edges(d)[cell] == lower_corner[d] : cell == 0;
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
      if (levels)
        return levels->level(index) < levels->n_levels();
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

    /// The edges of all cells in a direction; none if they are equal.
    const std::vector<double> &
    edges(const unsigned int d) const
    {
      return all_edges ? (*all_edges)[d] : no_edges;
    }

    /// Return the lower edge of a cell, and behind the last cell its upper one.
    double
    edge(const unsigned int d, const unsigned int cell) const
    {
      const std::vector<double> &given = edges(d);
      return given.empty() ? lower_corner[d] + sizes[d] * cell : given[cell];
    }

    /// Return the size of the smallest cells in a direction.
    double
    cell_size(const unsigned int d) const
    {
      return sizes[d];
    }

    /// Return the size of a cell in a direction.
    double
    cell_size(const unsigned int d, const unsigned int cell) const
    {
      const std::vector<double> &given = edges(d);
      return given.empty() ? sizes[d] : given[cell + 1] - given[cell];
    }

    /// Return the size of the largest cells in a direction.
    double
    largest_cell_size(const unsigned int d) const;

    /// Return the place of a coordinate in units of cells from the lower
    /// corner. Cells beyond the ends have the size of the first or the last
    /// one.
    double
    place(const unsigned int d, const double x) const
    {
      return edges(d).empty() ? (x - lower_corner[d]) / sizes[d]
                              : place_between(edges(d), x);
    }

    /// Return the place() of a point in all directions; in a refined mesh among
    /// the cells of the level of the active cell there.
    dealii::Point<dim>
    places(const dealii::Point<dim> &x) const
    {
      dealii::Point<dim>    result;
      const MultiIndex<dim> cell = levels ? levels->find(x) : MultiIndex<dim>();
      for (unsigned int d = 0; d < dim; ++d)
        result[d] =
          levels ? cell[d] + (x[d] - edge(d, cell[d])) / cell_size(d, cell[d])
                 : place(d, x[d]);
      return result;
    }

    /// Return the smallest size among a cell and its two neighbours, or a lower
    /// bound of it if the neighbours may belong to another level.
    double
    smallest_near(const unsigned int d, const unsigned int cell) const
    {
      if (edges(d).empty())
        return sizes[d];
      double h = cell_size(d, cell);
      if (levels)
        return std::max(0.5 * h, sizes[d]);
      if (cell > 0)
        h = std::min(h, cell_size(d, cell - 1));
      if (cell + 1 < cells[d])
        h = std::min(h, cell_size(d, cell + 1));
      return h;
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
          const std::vector<double> &given = edges(d);
          if (given.empty())
            {
              result.size[d]   = sizes[d];
              result.lower[d]  = lower_corner[d] + sizes[d] * index[d];
              result.center[d] = lower_corner[d] + sizes[d] * (index[d] + 0.5);
              continue;
            }
          result.lower[d]  = given[index[d]];
          result.size[d]   = given[index[d] + 1] - given[index[d]];
          result.center[d] = 0.5 * (given[index[d]] + given[index[d] + 1]);
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

    static double
    place_between(const std::vector<double> &edges, const double x);

    std::shared_ptr<const CellHierarchy<dim>> levels;

    std::shared_ptr<const CellEdges<dim>> all_edges;
    static const std::vector<double>      no_edges;

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
  /// both ends are neighbours. In directions with @p edges, cells lie between
  /// these n_cells + 1 numbers, which increase from the lower to the upper
  /// corner; a manifold of the mesh places the vertices. Throws
  /// dealii::ExcMessage for other numbers of edges, edges that do not increase,
  /// and edges in periodic directions.
  ///
  /// With @p levels, cells are refined; n_cells and edges then refer to level
  /// 0, and no direction may be periodic.
  template <int dim>
  void
  create_box_mesh(
    DistributedTriangulation<dim>                   &triangulation,
    const dealii::Point<dim>                        &lower,
    const dealii::Point<dim>                        &upper,
    const MultiIndex<dim>                           &n_cells,
    const std::array<bool, dim>                     &periodic = {},
    const CellEdges<dim>                            &edges    = {},
    const std::shared_ptr<const CellHierarchy<dim>> &levels   = nullptr);

  /// Collective. Halve and join the cells of a mesh with levels, by
  /// create_box_mesh(), as other levels of the same cells require.
  template <int dim>
  void
  adapt_box_mesh(DistributedTriangulation<dim>                   &triangulation,
                 const std::shared_ptr<const CellHierarchy<dim>> &levels);

  /// Collective. Return the positions of all refined cells of a mesh with
  /// levels, ascending.
  template <int dim>
  std::vector<std::uint64_t>
  refined_cells(const DistributedTriangulation<dim> &triangulation);

  /// The settings required of a triangulation for a SplineSpace, which asks
  /// p4est for the owners of points.
  template <int dim>
  constexpr typename DistributedTriangulation<dim>::Settings mesh_settings =
    DistributedTriangulation<dim>::communicate_vertices_to_p4est;
} // namespace greville

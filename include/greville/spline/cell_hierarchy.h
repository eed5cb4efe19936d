// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>

#include <greville/base/compatibility.h>
#include <greville/spline/cell_box.h>

#include <functional>
#include <unordered_map>

namespace greville
{
  /**
   * The cells of a refined grid: each level is a lattice whose cells have half
   * the size of the cells of the level before. Where the cells of a level are
   * *refined*, their @f$ 2^\text{dim} @f$ children take their place; a cell
   * that exists and is not refined is *active*. Level 0 is the grid without
   * refinement.
   *
   * A cell is refined if the constructor's argument @p wanted returns true for
   * it and for the cells that contain it, or if one of the following rules
   * requires it (doc/user/grids.md):
   * - the children of a cell are refined together,
   * - around a refined cell, there are r rings of cells of its level: r = p, or
   *   1 for order p = 2. The splines of a cell then belong to two levels at
   *   most.
   *
   * Indices of cells count all levels, so that cells and functions of all
   * levels have positions in one array: level l begins in direction d at
   * offset(l)[d], behind the cells of the levels before and a gap, which is
   * larger than the supports of splines.
   *
   * The refined cells follow from the arguments only. They are determined on
   * demand and then stored, so that no array has the size of a level.
   */
  template <int dim>
  class CellHierarchy
  {
  public:
    /// A function that returns whether to refine the cell of a level that fills
    /// a box.
    using Wanted =
      std::function<bool(const unsigned int, const CellBox<dim> &)>;

    /// The number of indices between two levels.
    static constexpr unsigned int gap = 11;

    /// Make a hierarchy with @p n_levels above level 0, whose cells lie between
    /// the @p edges (with both ends of the grid), for splines of order
    /// @p degree.
    CellHierarchy(const CellEdges<dim> &edges,
                  const unsigned int    n_levels,
                  const unsigned int    degree,
                  const Wanted         &wanted);

    /// Return a hierarchy that refines the cells at these positions, too. They
    /// belong to levels before the last one.
    std::shared_ptr<const CellHierarchy>
    refined_also(const std::vector<std::uint64_t> &positions) const;

    /// Return a hierarchy in which only the cells at these positions, of levels
    /// before the last one, and the cells that contain them, are wanted.
    std::shared_ptr<const CellHierarchy>
    refined_only(const std::vector<std::uint64_t> &positions) const;

    /// Return the number of lattices, level 0 included.
    unsigned int
    n_levels() const
    {
      return offsets.size();
    }

    const MultiIndex<dim> &
    offset(const unsigned int level) const
    {
      return offsets[level];
    }

    /// Return the number of cells that a level has in each direction if all
    /// cells are refined.
    MultiIndex<dim>
    n_cells(const unsigned int level) const;

    /// Return the edges of all levels, by index: edge i is the lower one of
    /// cell i.
    const std::shared_ptr<const CellEdges<dim>> &
    edges() const
    {
      return all_edges;
    }

    /// Return the index of a cell at a position in the array of all levels.
    MultiIndex<dim>
    index(const std::uint64_t position) const
    {
      MultiIndex<dim> extents;
      for (unsigned int d = 0; d < dim; ++d)
        extents[d] = (*all_edges)[d].size() - 1;
      return multi_index<dim>(position, extents);
    }

    /// Return only the edges of the last level.
    CellEdges<dim>
    finest_edges() const;

    /// Return the level of a cell, or n_levels() if the index is in a gap.
    unsigned int
    level(const MultiIndex<dim> &index) const;

    /// Return the level of a function, by its index in direction 0.
    unsigned int
    level_of_function(const unsigned int index) const
    {
      unsigned int l = n_levels() - 1;
      while (index < offsets[l][0])
        --l;
      return l;
    }

    /// Return the cell of the level before that contains a cell.
    MultiIndex<dim>
    parent(const MultiIndex<dim> &index) const;

    /// Return whether a cell of a level is refined, if it exists.
    bool
    is_refined(const MultiIndex<dim> &index) const;

    /// Return whether a cell is active. False in gaps.
    bool
    is_active(const MultiIndex<dim> &index) const;

    /// Return the active cell that contains a point; the nearest one for points
    /// outside.
    MultiIndex<dim>
    find(const dealii::Point<dim> &point) const;

    /// Return the centre of a cell in units of half cells of the last level.
    std::array<int, dim>
    center(const MultiIndex<dim> &index) const;

    /// Return the number of cells of the last level along a cell.
    unsigned int
    width(const MultiIndex<dim> &index) const
    {
      return 1u << (n_levels() - 1 - level(index));
    }

  private:
    /// Want these cells, and the cells that contain them.
    void
    want(const std::vector<std::uint64_t> &positions);

    /// Return whether a cell, counted from offset(level), is wanted.
    bool
    is_wanted(const unsigned int level, const MultiIndex<dim> &cell) const;

    /// Return whether a cell, counted from offset(level), is refined if it
    /// exists.
    bool
    find_refined(const unsigned int level, const MultiIndex<dim> &cell) const;

    CellBox<dim>
    box(const unsigned int level, const MultiIndex<dim> &cell) const;

    Wanted                                wanted;
    const unsigned int                    n_rings;
    std::vector<MultiIndex<dim>>          offsets;
    MultiIndex<dim>                       n_coarse;
    std::shared_ptr<const CellEdges<dim>> all_edges;

    // Answers of is_wanted(), for children of wanted cells, and of
    // find_refined(), by level and position.
    mutable std::vector<std::unordered_map<std::uint64_t, bool>> known_wanted,
      refined;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/array_view.h>

#include <greville/points/point_ref.h>
#include <greville/spline/spline_space.h>

#include <type_traits>
#include <vector>

namespace greville
{
  /**
   * The material points of one body on this process, sorted by cells.
   *
   * Points are stored in *groups* of four points of one cell, each an array
   * [k][lane] for number k (a double) of a point. A kernel loads one number of
   * all points of a group by one instruction. The groups of a cell form a
   * linked list; all but the first are full. Empty lanes contain a point
   * without mass and volume at the centre of the cell. It contributes nothing,
   * so kernels need no masks. Only points that change their cell are copied;
   * defragment() restores the order of the cells when many have moved.
   *
   * Cells are numbered as in SplineSpace::owned_cells().
   */
  template <int dim>
  class MaterialPoints
  {
  public:
    static constexpr unsigned int none = -1;

    /// The number of points of a group.
    static constexpr unsigned int width = 4;

    /// The space is kept by reference; its order does not matter.
    void
    reinit(const SplineSpace<dim> &space, const PointLayout<dim> &layout);

    const PointLayout<dim> &
    layout() const
    {
      return point_layout;
    }

    /// Replace the space by another space on the same cells.
    void
    set_space(const SplineSpace<dim> &space)
    {
      AssertThrow(space.owned_cells().size() == heads.size(),
                  dealii::ExcDimensionMismatch(space.owned_cells().size(),
                                               heads.size()));
      spline_space = &space;
    }

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    /// Return the number of points on this process.
    std::size_t
    n_points() const
    {
      return n_all_points;
    }

    unsigned int
    n_points(const unsigned int cell) const
    {
      return counts[cell];
    }

    /// Return the cells with points, ascending.
    const std::vector<unsigned int> &
    cells() const;

    /// Return the first group of a cell, or none if there is no point.
    unsigned int
    first_group(const unsigned int cell) const
    {
      return heads[cell];
    }

    /// Return the group after @p group in the list of its cell, or none.
    unsigned int
    next_group(const unsigned int group) const
    {
      return links[group];
    }

    /// Return the number of points in the first group of a cell; the other
    /// groups are full.
    unsigned int
    n_in_first_group(const unsigned int cell) const
    {
      return counts[cell] == 0 ? 0 : (counts[cell] - 1) % width + 1;
    }

    /// Return the numbers of a group: number k of lane l is at k * width + l.
    double *
    group(const unsigned int g)
    {
      return data.data() + std::size_t(g) * point_layout.size * width;
    }

    const double *
    group(const unsigned int g) const
    {
      return data.data() + std::size_t(g) * point_layout.size * width;
    }

    /// Call @p action(point) or @p action(cell, point) for all points, with a
    /// PointRef or a ConstPointRef.
    template <typename Action>
    void
    for_each(const Action &action)
    {
      for_each_of<PointRef<dim>>(*this, action);
    }

    template <typename Action>
    void
    for_each(const Action &action) const
    {
      for_each_of<ConstPointRef<dim>>(*this, action);
    }

    /// Call @p action(point) for all points of a cell.
    template <typename Action>
    void
    for_each_in_cell(const unsigned int cell, const Action &action) const
    {
      unsigned int n = n_in_first_group(cell);
      for (unsigned int g = heads[cell]; g != none; g = links[g], n = width)
        for (unsigned int lane = 0; lane < n; ++lane)
          action(ConstPointRef<dim>(group(g) + lane, width));
    }

    /// Return the point in a lane of a group.
    PointRef<dim>
    point(const unsigned int g, const unsigned int lane)
    {
      return PointRef<dim>(group(g) + lane, width);
    }

    ConstPointRef<dim>
    point(const unsigned int g, const unsigned int lane) const
    {
      return ConstPointRef<dim>(group(g) + lane, width);
    }

    /// Reserve memory for a number of groups.
    void
    reserve(const std::size_t n_groups);

    /// Add a point, given by its layout().size numbers, to a cell.
    void
    insert(const unsigned int                     cell,
           const dealii::ArrayView<const double> &values);

    /// Remove points of @p cell whose position is outside of it, and append
    /// their numbers to @p leaving.
    void
    remove_leaving(const unsigned int cell, std::vector<double> &leaving);

    /// Sort the groups in the order of the cells, in place.
    void
    defragment();

    /// Return the bytes of points and lists on this process.
    std::size_t
    memory_consumption() const
    {
      return data.capacity() * sizeof(double) +
             (heads.capacity() + counts.capacity() + links.capacity() +
              filled_cells.capacity()) *
               sizeof(unsigned int);
    }

  private:
    template <typename Ref, typename Points, typename Action>
    static void
    for_each_of(Points &points, const Action &action)
    {
      for (const unsigned int cell : points.cells())
        {
          unsigned int n = points.n_in_first_group(cell);
          for (unsigned int g = points.heads[cell]; g != none;
               g = points.links[g], n = width)
            for (unsigned int lane = 0; lane < n; ++lane)
              if constexpr (std::is_invocable_v<Action, Ref>)
                action(Ref(points.group(g) + lane, width));
              else
                action(cell, Ref(points.group(g) + lane, width));
        }
    }

    unsigned int
    new_group();

    void
    clear_lane(const unsigned int cell,
               const unsigned int g,
               const unsigned int lane);

    const SplineSpace<dim> *spline_space = nullptr;
    PointLayout<dim>        point_layout;
    std::size_t             n_all_points = 0;

    // The numbers of all groups. Spare memory makes reallocation rare.
    dealii::AlignedVector<double> data;
    std::vector<unsigned int>     heads;  // per cell
    std::vector<unsigned int>     counts; // per cell
    std::vector<unsigned int>     links;  // per group
    unsigned int                  free_groups = none;

    mutable std::vector<unsigned int> filled_cells;
    mutable bool                      filled_cells_are_valid = false;
  };



  /// Return the volume of owned cell number @p cell that points of a @p layout
  /// fill.
  template <int dim>
  inline double
  cell_volume(const SplineSpace<dim> &space,
              const unsigned int      cell,
              const PointLayout<dim> &layout)
  {
    const CellBox<dim> box = space.box(cell);
    return box.volume() * layout.thickness(box.center);
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/material_points.h>

#include <unordered_map>

namespace greville
{
  /// A transport of points to the cells and processes to which they have moved.
  /// Points that leave the grid by less than 1e-9 cells are moved back onto its
  /// wall. Points that leave it in a periodic direction re-enter on the other
  /// side: their position and reference position move by whole periods, so that
  /// the displacement does not change.
  template <int dim>
  class PointTransport
  {
  public:
    /// Collective. Triangulation and space are kept by reference.
    void
    reinit(const SplineSpace<dim> &space);

    /// The result for points of a body on this process that left their cells.
    struct Result
    {
      std::size_t n_moved   = 0;
      std::size_t n_sent    = 0;
      std::size_t n_removed = 0;
      /// The mass of removed points.
      double removed_mass = 0.;
      /// The id of a point outside the grid, and its position.
      std::int64_t       outside = -1;
      dealii::Point<dim> outside_position;
    };

    /// Collective. Move the points that have left @p left_cells. Points outside
    /// the grid are removed and counted.
    Result
    move(MaterialPoints<dim>             &points,
         const std::vector<unsigned int> &left_cells);

    /// Collective. Insert points into their cells, on any process. For each
    /// point, @p rows contains the lexicographic position of its cell followed
    /// by its numbers. Points of a cell are sorted by the calling process, and
    /// then by their order in @p rows.
    void
    insert(MaterialPoints<dim> &points, const std::vector<double> &rows);

  private:
    std::vector<unsigned int>
    find_owners(const std::vector<std::uint64_t> &cells) const;

    const SplineSpace<dim>                         *spline_space = nullptr;
    MPI_Comm                                        comm = MPI_COMM_NULL;
    std::unordered_map<std::uint64_t, unsigned int> owners_of_ghost_cells;
    // The numbers of leaving points in move(), kept for its memory.
    std::vector<double> leaving;
  };
} // namespace greville

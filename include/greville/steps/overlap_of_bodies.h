// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/contact/local_cells.h>
#include <greville/contact/overlap.h>
#include <greville/points/body.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace greville
{
  /// The bodies of two sides.
  template <int dim>
  using Sides = std::array<std::vector<const Body<dim> *>, 2>;

  template <int dim>
  using Inside = std::function<bool(const dealii::Point<dim> &x)>;

  /// The depth from which an overlap is an error, half a cell: as a fraction of
  /// the cell size, and as the increase of Overlap::excess above its initial
  /// value. Points that fill cells extend beyond their shape by part of a
  /// spacing.
  constexpr double half_of_cell = 0.5, half_of_cell_as_excess = 0.3;

  /// Collective. Find the largest overlap of two sides in the cells of one or
  /// two lattices, see largest_overlap(): in equal cells, or between the edges
  /// of all cells of a grid of which both are parts. In refined grids, each
  /// level is searched with the points in its cells and in smaller ones.
  template <int dim>
  Overlap<dim>
  overlap_of_bodies(const Sides<dim>                &sides,
                    const std::vector<Lattice<dim>> &lattices,
                    const MPI_Comm                   comm);

  /// Return "a point of 'Body NAME' at (0.1, 0.2) m is inside of OTHER".
  template <int dim>
  std::string
  inside_text(const Body<dim>          &body,
              const dealii::Point<dim> &x,
              const std::string        &other);

  /// Return the same text for the point of an overlap.
  template <int dim>
  std::string
  overlap_text(const Sides<dim> &sides, const Overlap<dim> &overlap);

  /// Return whether @p x and the points at a @p distance (m) from it, along the
  /// axes and the diagonals, are all inside.
  template <int dim>
  bool
  is_deep(const Inside<dim>        &is_inside,
          const dealii::Point<dim> &x,
          const double              distance);

  /// Return @p is_inside, mirrored at the axis, for axisymmetric bodies.
  template <int dim>
  Inside<dim>
  mirrored(const Inside<dim> &is_inside, const bool is_axisymmetric);
} // namespace greville

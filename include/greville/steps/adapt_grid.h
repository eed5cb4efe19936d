// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// Collective. Return whether the cells of a space are the active cells of
  /// these levels.
  template <int dim>
  bool
  has_cells_of(const SplineSpace<dim> &space, const CellHierarchy<dim> &levels);

  /// Collective. Return the positions of cells of a refined grid that have
  /// to be halved because functions at their edges depend on the few @p points
  /// of cut cells only (LevelFunctions).
  template <int dim>
  std::vector<std::uint64_t>
  cells_at_surfaces(const SplineSpace<dim>                         &space,
                    const std::vector<const MaterialPoints<dim> *> &points);



  /// The results of adapt_grid().
  struct Adaptation
  {
    bool          changes_cells = false;
    std::uint64_t n_divided     = 0; // points of bodies
    /// True if 'Grid/Most cells' kept an indicator from halving cells.
    bool is_limited = false;
  };



  /**
   * Collective. Halve and join the cells of the grid as the regions of
   * 'Grid/Refinement' require at the time of the @p state, and divide points
   * that are large for their cell. If cells change, @p release is called first,
   * to destroy objects that refer to the old spaces; the discretization is then
   * made anew, and its fields of the state are zero. Cells that are refined
   * because of surfaces remain so until other cells change.
   *
   * A point is divided into 2^dim points if its volume exceeds 1.5 times the
   * 2^dim-th part of its cell, so that two points are left in each direction.
   * They share its mass and volume equally, and have its velocity, deformation,
   * stress and history: mass, momentum and energy do not change. They lie at
   * the centres of the parts of a box that has the proportions of the cell and
   * is deformed by F. Points of surfaces are divided likewise, into
   * 2^(dim - 1) points in their plane.
   */
  template <int dim>
  Adaptation
  adapt_grid(State<dim>                  &state,
             Discretization<dim>         &discretization,
             const SimulationParameters  &parameters,
             const std::function<void()> &release);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/spline_space.h>

#include <functional>
#include <map>

namespace greville
{
  /**
   * The functions of a refined grid that belong to the truncated hierarchical
   * basis (@ref Giannelli2012 "Giannelli, Juettler and Speleers, 2012"), and
   * the coefficients of all other functions in terms of theirs.
   *
   * With the region @f$ \Omega^l @f$ of cells of level l or higher, a function
   * of level l is *active* if its support lies in @f$ \Omega^l @f$ and contains
   * an active cell of level l. Another function i of level l is *tied*: its
   * coefficient follows from functions j of the level before, by insertion of
   * knots:
   * @f[ y^l_i = \sum_j S_{ij} \, y^{l-1}_j . @f]
   * A spline is then as smooth between levels as it is in a level.
   *
   * A function without a well-filled cell (CellFilling) on its own level
   * depends on few points. If its support contains refined cells, the rest of
   * the support counts as refined, too: functions of the next level become
   * active there, and the function is *released*. On its remaining cells, a
   * released function extends the polynomials of hosts, as Extension does at
   * the surface of a body.
   */
  template <int dim>
  class LevelFunctions
  {
  public:
    /// The entries of a row: positions of functions and weights.
    using Row = std::vector<std::pair<std::uint64_t, double>>;

    /// Collective. Find active functions for a space on a refined grid, kept by
    /// reference. @p is_filled says whether a local function has a well-filled
    /// cell.
    void
    reinit(const SplineSpace<dim>                        &space,
           const std::function<bool(const unsigned int)> &is_filled);

    /// Return whether the coefficient of a local function follows from
    /// functions of the level before.
    bool
    is_tied(const unsigned int function) const
    {
      return kinds[function] == tied;
    }

    /// Return whether the support of a local function contains refined cells,
    /// and the function keeps its coefficient.
    bool
    is_at_refined_cells(const unsigned int function) const
    {
      return !kinds.empty() && kinds[function] == at_refined;
    }

    /// Return the positions of the owned cells that count as refined, because
    /// functions are released.
    std::vector<std::uint64_t>
    cells_to_refine() const;

    /// Collective. Replace tied functions in @p rows, anywhere in the grid, by
    /// functions that are not tied. Entries become unique, with ascending
    /// positions.
    void
    resolve(std::vector<Row> &rows) const;

  private:
    enum Kind : unsigned char
    {
      active,     // no refined cell in the support
      at_refined, // active, with refined cells in the support
      tied,
      released
    };

    /// Return the level of a local function.
    unsigned int
    level(const unsigned int function) const;

    /// Call visit(cell) for the cells of level @p l that contain the support of
    /// a local function of this or the next level.
    template <typename Visit>
    void
    for_each_cell(const unsigned int function,
                  const unsigned int l,
                  const Visit       &visit) const;

    /// Set the kinds of the local functions of a level. @p counts_as_refined
    /// are the positions of cells of the level before that are not refined, but
    /// count as refined.
    void
    find_kinds(const unsigned int                             level,
               const std::map<std::uint64_t, bool>           &counts_as_refined,
               const std::function<bool(const unsigned int)> &is_filled);

    /// Collective. Return which active cells of a level count as refined, for
    /// the local functions of the next level.
    std::map<std::uint64_t, bool>
    find_cells_that_count(const unsigned int level) const;

    /// Return whether an owned cell counts as refined.
    bool
    counts_as_refined(const unsigned int cell) const;

    /// Return the row of a tied function.
    Row
    tie(const unsigned int function) const;

    const SplineSpace<dim>    *spline_space = nullptr;
    const CellHierarchy<dim>  *hierarchy    = nullptr;
    std::vector<unsigned char> kinds; // by local function
  };
} // namespace greville

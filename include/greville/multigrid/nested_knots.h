// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace greville
{
  /// The knots of B-splines of order p in one direction of a lattice, and of
  /// coarser lattices, given by the breakpoints between cells. Knots at the
  /// ends are repeated, or the direction is periodic. Function i has the knots
  /// number i - p to i + 1.
  class NestedKnots
  {
  public:
    NestedKnots() = default;

    /// Cells between @p edges; if there are none, equal cells of length 1.
    NestedKnots(const unsigned int         degree,
                const unsigned int         n_cells,
                const bool                 periodic,
                const std::vector<double> &edges = {});

    /// The knots of the levels of a refined grid. Level l begins with function
    /// @p begin[l]; functions between levels do not exist.
    NestedKnots(const std::vector<NestedKnots>  &levels,
                const std::vector<unsigned int> &begin);

    bool
    is_periodic() const
    {
      return periodic;
    }

    int
    degree() const
    {
      return p;
    }

    int
    n_cells() const
    {
      return int(breakpoints.size()) - 1;
    }

    unsigned int
    n_levels() const
    {
      return levels ? levels->size() : 1;
    }

    /// Return the level of a function.
    unsigned int
    level(const int i) const
    {
      unsigned int l = n_levels() - 1;
      while (l > 0 && i < int(begin_of_levels[l]))
        --l;
      return l;
    }

    /// The breakpoints between cells.
    const std::vector<double> &
    edges() const
    {
      return breakpoints;
    }

    int
    n_functions() const
    {
      return levels ? end_of_levels : periodic ? n_cells() : n_cells() + p;
    }

    /// Return the knots of cells of twice the size. If cells have different
    /// sizes, the smallest cells are joined in pairs. Returns the same knots if
    /// there is one cell or a period would have too few. If there are several
    /// levels, returns the knots without the last level.
    NestedKnots
    coarser() const;

    /// Return the cell of the Greville point of function @p i (the mean of its
    /// inner knots), and the fraction of the cell before this point. The last
    /// breakpoint has a cell of its own.
    std::pair<unsigned int, double>
    greville_point(const int i) const;

    /// A row of the matrix that inserts knots: the weights of the coarse
    /// functions first, first + 1, ...
    struct Row
    {
      int                first;
      std::vector<float> weights;
    };

    /// Return the row of function @p i for the @p coarse knots, which are a
    /// part of these knots. In a periodic direction, @p i may be any integer.
    /// The row is empty if the function does not exist. Functions of levels
    /// that the @p coarse knots have stay the same; the others are interpolated
    /// by the last of these levels.
    Row
    insertion(const int i, const NestedKnots &coarse) const;

  private:
    /// Return knot number @p k, counted from the first breakpoint.
    double
    knot(const int k) const;

    int                 p          = 0;
    bool                periodic   = false;
    bool                is_uniform = true;
    std::vector<double> breakpoints;

    // The levels of a refined grid, otherwise null.
    std::shared_ptr<const std::vector<NestedKnots>> levels;
    std::vector<unsigned int>                       begin_of_levels;
    int                                             end_of_levels = 0;
  };
} // namespace greville

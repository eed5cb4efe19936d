// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/cell_filling.h>
#include <greville/spline/level_functions.h>

namespace greville
{
  /**
   * Extended B-splines (@ref Hollig2001 "Hoellig, Reif and Wipper, 2001") for a
   * body that fills only a part of its grid. A function of a space is
   * - *inactive*: its cells are empty,
   * - *stable*: at least one of its cells is a *host*, a well-filled cell
   *   whose polynomials are extended to the cells around (see CellFilling),
   * - *extended*: no cell is a host, but at least one has a host. Its
   *   coefficient is the coefficient of the host's polynomial: the blossom b of
   *   this polynomial at the inner knots of the function i (de Boor and Fix),
   *   @f[ c_i = b(t_{i+1}, \dots, t_{i+p}) = \sum_j E_{ij} c_j, @f]
   *   direction by direction, with the @f$ (p + 1)^\text{dim} @f$ functions j
   *   of the host, which are all stable. Polynomials of order p are therefore
   *   extended exactly, at the walls of the grid, too. If its cells have
   *   several hosts, their extensions are averaged, because a function over a
   *   hole in the body belongs to all of its sides: with the weights
   *   @f$ d^{-12} @f$ of the distance d of host and function in 2D, and over
   *   the nearest hosts in 3D (doc/results/mass_of_points.md has the effect),
   * - *lumped*: its cells are fragments only. Such functions stay, but without
   *   their products with other functions: see ExtendedMass.
   *
   * In a refined grid, tied functions (LevelFunctions) are extended functions,
   * too: their rows contain the functions from which their coefficients follow.
   * Tied functions of a host are replaced by these functions in all rows.
   *
   * Numbers of functions are the local ones of the space; all functions of
   * owned cells have a class on each process.
   */
  template <int dim>
  class Extension
  {
  public:
    enum Class : unsigned char
    {
      inactive,
      stable,
      extended,
      lumped
    };

    /// The numbers of functions of each class on all processes.
    struct Counts
    {
      std::uint64_t stable = 0, extended = 0, lumped = 0;
    };

    Extension() = default;

    Extension(const SplineSpace<dim> &space, const CellFilling<dim> &filling)
    {
      reinit(space, filling);
    }

    /// Collective. Compute the extension. Space and filling, which must share a
    /// mesh, are kept by reference until the next call. If the extension is
    /// @p constant, an extended function takes the coefficient of the nearest
    /// function of its host.
    void
    reinit(const SplineSpace<dim> &space,
           const CellFilling<dim> &filling,
           const bool              constant = false);

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    /// Return the relations of the functions of a refined grid.
    const LevelFunctions<dim> &
    level_functions() const
    {
      return levels;
    }

    Class
    operator[](const unsigned int function) const
    {
      return static_cast<Class>(classes[function]);
    }

    /// Return the local numbers of the extended functions of owned cells.
    const std::vector<unsigned int> &
    extended_functions() const
    {
      return functions.numbers;
    }

    /// Rows @f$ E_{ij} @f$: row k has the entries from begin[k] to begin[k +
    /// 1], with the lexicographic positions of the functions j, ascending, and
    /// the weights; at most @f$ (p + 1)^\text{dim} @f$ entries if the function
    /// i has one host.
    struct Rows
    {
      std::vector<std::size_t>   begin = {0};
      std::vector<std::uint64_t> positions;
      std::vector<double>        weights;
    };

    /// Return the rows of extended_functions().
    const Rows &
    rows() const
    {
      return functions.rows;
    }

    /// Return the row of one of extended_functions().
    void
    row(const unsigned int          function,
        std::vector<std::uint64_t> &positions,
        std::vector<double>        &weights) const;

    /// Collective. Return the numbers of functions of each class on all
    /// processes.
    Counts
    counts() const;

  private:
    using HostOfFunction = std::pair<unsigned int, std::uint64_t>;

    struct ExtendedFunctions
    {
      std::vector<unsigned int>  numbers; // ascending
      std::vector<std::uint64_t> hosts;
      std::vector<std::size_t>   hosts_begin; // by function, with the end
      Rows                       rows;
    };

    /// Return whether a function that is not inactive or tied is stable.
    bool
    is_stable(const unsigned int function) const;

    void
    find_hosts();

    /// Sort, and remove duplicates.
    void
    sort(std::vector<HostOfFunction> &found) const;

    /// Make rows, or copy the rows of @p old functions with the same hosts.
    void
    make_rows(const ExtendedFunctions &old);

    /// Collective. Make rows in a refined grid, which contain tied functions.
    void
    make_rows_of_levels();

    using Row = typename LevelFunctions<dim>::Row;

    /// Return the row of function number k from its hosts, with ascending
    /// positions.
    Row
    row_from_hosts(const unsigned int k) const;

    /// Return the squared distance from the centre of a host to the centre of a
    /// function, by indices, in half cells of the host. In a periodic grid, the
    /// function is shifted by @p periods.
    double
    square_of_distance(const MultiIndex<dim>      &host,
                       const MultiIndex<dim>      &function,
                       const std::array<int, dim> &periods) const;

    void
    append(const Row &row);

    const SplineSpace<dim>    *spline_space = nullptr;
    const CellFilling<dim>    *cell_filling = nullptr;
    bool                       is_constant  = false;
    std::vector<unsigned char> classes;
    ExtendedFunctions          functions;
    VectorType                 support_weights;
    LevelFunctions<dim>        levels; // of a refined grid
  };
} // namespace greville

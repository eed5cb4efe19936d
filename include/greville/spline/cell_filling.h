// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/cell_neighbors.h>

namespace greville
{
  /**
   * Classes of the cells of a mesh by the material in them: a cell is *empty*,
   * *cut* (it contains too few points to determine splines) or *well-filled*.
   * The polynomials of a spline on certain well-filled cells, the *hosts*, are
   * extended to the other cells of the body. Hosts are the cells inside the
   * body: all their neighbours (in 3D, the face neighbours) are well-filled,
   * too, and none is beyond a wall. The hosts of a cell are the nearest hosts
   * among its neighbours (by a face, an edge or a vertex) or, if no neighbour
   * is a host, the nearest among the hosts of its neighbours. All of these
   * cells contain points, so a host never lies across a gap. If several hosts
   * are equally near, all of them count, so results do not depend on the
   * numbering of the grid. Cells without a host are *fragments*: spray, and
   * parts less than three cells thick.
   *
   * With *outer hosts*, the well-filled cells among fragments are hosts, too,
   * so that few functions of tips and thin parts depend on the few points of
   * cut cells. Quasi-static steps use outer hosts, since the functions of
   * fragments then have a stiffness, but no mass. In dynamic steps, the mass of
   * fragments is lumped, which needs no host.
   *
   * Because surface cells are no hosts, functions that touch a body only at a
   * corner are not unknowns, and the polynomials of the two outermost layers of
   * cells are joined, as by the not-a-knot condition of spline interpolation.
   * The order of approximation is unchanged; the highest frequencies, outliers
   * of surfaces and walls, vanish (doc/results/mass_of_points.md). The
   * condition on walls is ignored in directions of one or two cells and at
   * *contact walls*. Since contact can begin and end within a step, functions
   * that do not vanish at contact walls are unknowns if possible.
   *
   * With *rims*, the empty cells around cells with points are marked as beyond
   * the body, so that functions are extended to all cells that the points'
   * domains reach (CellWindows).
   *
   * The classes depend on the mesh only, not on the order of the splines.
   */
  template <int dim>
  class CellFilling
  {
  public:
    /// Contact walls: x low, x high, y low, ...
    using Walls = std::array<bool, 2 * dim>;

    CellFilling() = default;

    /// The space may have any order; it is kept by reference.
    CellFilling(const SplineSpace<dim> &space)
    {
      reinit(space);
    }

    /// Collective. Begin with the cells of another space, which have no class
    /// before update().
    void
    reinit(const SplineSpace<dim> &space,
           const Walls            &contact_walls = {},
           const bool              with_rims     = false);

    /// Return whether a side of the grid (SplineSpace::on_side()) is a contact
    /// wall.
    bool
    is_contact_wall(const unsigned int side) const
    {
      return contact_walls[side];
    }

    /// Collective. Compute the classes. @p filling is the filled fraction of
    /// each owned cell: 0 for an empty cell; from @p threshold on, the cell is
    /// well-filled. A negative number marks a cell *beyond* the body, without
    /// points, to which functions are extended if it has a host. With the
    /// threshold 0, all cells with points are hosts. All calls must agree on
    /// outer hosts. Returns whether the class of any cell, on any process,
    /// changed.
    bool
    update(const std::vector<double> &filling,
           const double               threshold,
           const bool                 with_outer_hosts = false);

    /// Return the owned cells that are not empty, ascending.
    const std::vector<unsigned int> &
    filled_cells() const
    {
      return filled;
    }

    /// Return the class of an owned cell: 0 empty, 1 cut, 2 well-filled, 3
    /// host, 4 beyond.
    unsigned char
    cell_class(const unsigned int cell) const
    {
      return classes[cell];
    }

    bool
    holds_points(const unsigned int cell) const
    {
      return classes[cell] != empty && classes[cell] != beyond;
    }

    bool
    is_well_filled(const unsigned int cell) const
    {
      return classes[cell] == well_filled;
    }

    bool
    is_host(const unsigned int cell) const
    {
      return classes[cell] == host;
    }

    /// Return pairs of an owned cell that is not a host and the position (in
    /// Lattice::n_cells()) of one of its hosts, ascending.
    const std::vector<std::pair<unsigned int, std::uint64_t>> &
    hosts() const
    {
      return hosts_of_cells;
    }

    /// Collective. Return the number of fragments on all processes.
    std::uint64_t
    n_fragments() const
    {
      std::uint64_t n = 0;
      for (const unsigned int c : filled)
        n += !is_host(c);
      for (unsigned int k = 0; k < hosts_of_cells.size(); ++k)
        n -= k == 0 || hosts_of_cells[k].first != hosts_of_cells[k - 1].first;
      return dealii::Utilities::MPI::sum(n, spline_space->communicator());
    }

  private:
    enum Class : unsigned char
    {
      empty,
      cut,
      well_filled,
      host,
      beyond
    };

    struct HostSearch;

    void
    find_hosts(const bool with_outer_hosts);

    const SplineSpace<dim> *spline_space  = nullptr;
    bool                    all_are_hosts = false, has_rims = false;
    Walls                   contact_walls{};

    // The local cells, and the classes of the cells.
    CellNeighbors<dim>         neighbors;
    std::vector<unsigned char> classes;
    // The classes of owned cells that follow from the arguments of update():
    // without hosts, and beyond the body only for marked cells.
    std::vector<unsigned char> given;
    std::vector<unsigned int>  filled;

    std::vector<std::pair<unsigned int, std::uint64_t>> hosts_of_cells;
  };
} // namespace greville

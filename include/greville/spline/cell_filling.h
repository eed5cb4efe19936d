// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_cell_filling_h
#define greville_spline_cell_filling_h

#include <greville/spline/cell_neighbors.h>

namespace greville
{
  /**
   * Which cells of a mesh a body fills: a cell is *empty*, *cut* (it holds
   * points, but too few for splines to be determined by them) or *well-filled*.
   * The polynomials of a spline on certain well-filled cells, the *hosts*, are
   * extended to the other cells of the body. Hosts are the cells inside the
   * body: all neighbours (in 3D those by a face) are well-filled, too, and none
   * is beyond a wall. The hosts of a cell are the nearest ones among its
   * neighbours (by a face, an edge or a vertex), or, where none is a host, the
   * nearest ones among the hosts that its neighbours have. All of these cells
   * hold points, so that a host never lies across a gap. Several hosts can be
   * equally near: all of them count, so that results do not depend on the
   * direction in which the grid is numbered. Cells without a host are
   * *fragments*: spray, and parts less than three cells thick.
   *
   * With *outer hosts* the well-filled cells among fragments are hosts
   * themselves, so that few functions of tips and thin parts depend on the few
   * points of cut cells. Quasi-static steps use them: fragments have a
   * stiffness there, and no mass that could hold such functions. Where mass
   * counts, that of fragments is lumped, which needs no host.
   *
   * Because surface cells are no hosts, functions that touch a body by a corner
   * only are not in its space, and the polynomials of the two outermost layers
   * of cells are joined, as by the not-a-knot condition of spline
   * interpolation. The order of approximation remains the same; the highest
   * frequencies, outliers of surface and walls, vanish
   * (doc/results/mass_of_points.md). Walls are ignored in directions of one or
   * two cells, and at *contact walls*. Contact can begin and end within a step,
   * so functions that do not vanish there have to be unknowns, if possible.
   *
   * With *rims*, the empty cells around those that hold points are beyond the
   * body, so that functions are extended to all cells that domains of points
   * reach (CellWindows).
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

    /**
     * The space is that of any order; it is kept by reference.
     */
    CellFilling(const SplineSpace<dim> &space)
    {
      reinit(space);
    }

    /**
     * Collective. Begin with the cells of another space, none of which has a
     * class before update().
     */
    void
    reinit(const SplineSpace<dim> &space,
           const Walls            &contact_walls = {},
           const bool              with_rims     = false);

    /**
     * Whether a function of a space does not vanish at a contact wall.
     */
    bool
    is_at_contact_wall(const MultiIndex<dim> &function,
                       const MultiIndex<dim> &n_functions) const
    {
      for (unsigned int d = 0; d < dim; ++d)
        if ((contact_walls[2 * d] && function[d] == 0) ||
            (contact_walls[2 * d + 1] && function[d] + 1 == n_functions[d]))
          return true;
      return false;
    }

    /**
     * Collective. @p filling, of each owned cell, is the part of it that is
     * filled; 0 is empty, and from @p threshold on the cell is well-filled. A
     * negative number marks a cell *beyond* the body, without points, to which
     * functions are to be extended if it has a host.
     * With the threshold 0 all cells with points are hosts. With outer hosts
     * or without them in all calls. Returns whether the class of any cell, on
     * any process, changed.
     */
    bool
    update(const std::vector<double> &filling,
           const double               threshold,
           const bool                 with_outer_hosts = false);

    /**
     * The owned cells that are not empty, ascending.
     */
    const std::vector<unsigned int> &
    filled_cells() const
    {
      return filled;
    }

    /**
     * Of an owned cell: 0 empty, 1 cut, 2 well-filled, 3 a host, 4 beyond.
     */
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
    is_host(const unsigned int cell) const
    {
      return classes[cell] == host;
    }

    /**
     * Pairs of an owned cell, unless it is a host itself, and the position (in
     * Lattice::n_cells()) of one of its hosts, ascending.
     */
    const std::vector<std::pair<unsigned int, std::uint64_t>> &
    hosts() const
    {
      return hosts_of_cells;
    }

    /**
     * Number of fragments of all processes. Collective.
     */
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

    void
    find_hosts(const bool with_outer_hosts);

    const SplineSpace<dim> *spline_space  = nullptr;
    bool                    all_are_hosts = false, has_rims = false;
    Walls                   contact_walls{};

    // By local cell of the neighbours, or owned cells.
    CellNeighbors<dim>         neighbors;
    std::vector<unsigned char> classes;
    // What update() was given, of owned cells: no hosts, and beyond the body
    // only what was marked.
    std::vector<unsigned char> given;
    std::vector<unsigned int>  filled;

    std::vector<std::pair<unsigned int, std::uint64_t>> hosts_of_cells;
  };
} // namespace greville

#endif

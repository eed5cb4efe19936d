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
   * is beyond a wall. The host of a cell is reached by at most `reach` moves
   * between neighbouring cells (by a face, an edge or a vertex) that all hold
   * points, so that a host never lies across a gap. Of the hosts of its
   * neighbours a cell takes the nearest, and among equally near ones the first
   * in lexicographic order, as seen from the cell. Cells without a host are
   * *fragments*: spray, and parts less than three cells thick.
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
   * The classes depend on the mesh only, not on the order of the splines.
   */
  template <int dim>
  class CellFilling
  {
  public:
    static constexpr std::uint64_t none = -1;

    /// Steps from a cell to its host.
    static constexpr unsigned int reach = 2;

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
     * Collective.
     */
    void
    reinit(const SplineSpace<dim> &space, const Walls &contact_walls = {});

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
     * filled; 0 is empty, and from @p threshold on the cell is well-filled.
     * With the threshold 0 all cells with points are hosts. Returns whether the
     * class of any cell, on any process, changed.
     */
    bool
    update(const std::vector<double> &filling, const double threshold);

    /**
     * The owned cells that are not empty, ascending.
     */
    const std::vector<unsigned int> &
    filled_cells() const
    {
      return filled;
    }

    /**
     * Of an owned cell: 0 empty, 1 cut, 2 well-filled, 3 a host.
     */
    unsigned char
    cell_class(const unsigned int cell) const
    {
      return classes[cell] == empty ? 0 : is_host(cell) ? 3 : classes[cell];
    }

    bool
    is_host(const unsigned int cell) const
    {
      return hosts[cell] == neighbors.positions()[cell];
    }

    /**
     * Position (in Lattice::n_cells()) of the host of an owned cell, which can
     * be the cell itself; none for empty cells and fragments.
     */
    std::uint64_t
    host(const unsigned int cell) const
    {
      return hosts[cell];
    }

    /**
     * Number of fragments of all processes. Collective.
     */
    std::uint64_t
    n_fragments() const
    {
      std::uint64_t n = 0;
      for (const unsigned int c : filled)
        n += hosts[c] == none;
      return dealii::Utilities::MPI::sum(n, spline_space->communicator());
    }

  private:
    enum Class : unsigned char
    {
      empty,
      cut,
      well_filled
    };

    void
    find_hosts();

    const SplineSpace<dim> *spline_space  = nullptr;
    bool                    all_are_hosts = false;
    Walls                   contact_walls{};

    // By local cell of the neighbours, or owned cells.
    CellNeighbors<dim>         neighbors;
    std::vector<unsigned char> classes;
    std::vector<std::uint64_t> hosts;
    std::vector<unsigned int>  filled;
  };
} // namespace greville

#endif

#ifndef greville_spline_cell_filling_h
#define greville_spline_cell_filling_h

#include <greville/spline/spline_space.h>

namespace greville
{
  /**
   * Which cells of a mesh a body fills: a cell is *empty*, *cut* (it holds
   * points, but too few for splines to be determined by them) or
   * *well-filled*. Each cut cell has a *host*, the nearest well-filled cell of
   * its own body: one that is reached through at most ::reach cells that are
   * neighbours (by a face, an edge or a vertex) and hold points. So a host does
   * not lie across a gap. Among hosts at the same distance the first in
   * lexicographic order is taken. Cells without a host are *fragments*.
   *
   * The classes depend on the mesh only, not on the order of the splines.
   */
  template <int dim>
  class CellFilling
  {
  public:
    static constexpr std::uint64_t none = -1;

    /**
     * The largest number of cells from a cut cell to its host.
     */
    static constexpr unsigned int reach = 3;

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
    reinit(const SplineSpace<dim> &space);

    /**
     * Collective. @p filling, of each owned cell, is the part of it that is
     * filled; 0 is empty, and from @p threshold on the cell is well-filled.
     * Returns whether the class of any cell, on any process, changed.
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

    bool
    is_host(const unsigned int cell) const
    {
      return hosts[cell] == positions[cell];
    }

    /**
     * Position (in Lattice::n_cells()) of the host of an owned cell: of the
     * cell itself if it is well-filled, none for empty cells and fragments.
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
    n_fragments() const;

  private:
    enum Class : unsigned char
    {
      empty,
      cut,
      well_filled
    };

    /**
     * Local number of a cell at a position, owned or a neighbour of an owned
     * one; invalid_unsigned_int for others.
     */
    unsigned int
    find(const std::uint64_t position) const;

    void
    find_hosts();

    const SplineSpace<dim> *spline_space = nullptr;

    // Owned cells, then those of the ghost layer; on several processes their
    // positions are looked up.
    std::vector<std::uint64_t>                          positions;
    std::vector<std::pair<std::uint64_t, unsigned int>> numbers;
    std::vector<unsigned int>                           places; // in exchange
    VectorType                                          exchange;
    std::vector<unsigned char>                          classes;
    std::vector<std::uint64_t>                          hosts;
    std::vector<unsigned int>                           filled;
  };
} // namespace greville

#endif

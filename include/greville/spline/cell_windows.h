// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_spline_cell_windows_h
#define greville_spline_cell_windows_h

#include <greville/base/vector_field.h>
#include <greville/spline/extension.h>

#include <algorithm>

namespace greville
{
  /**
   * The *window* of a cell: the @f$ (p + 3)^\text{dim} @f$ functions of a space
   * that do not vanish on the cell or on one of its neighbours (by a face, an
   * edge or a vertex). Points whose domains reach over the faces of their cell
   * see these functions.
   *
   * Coefficients lie in a buffer, function by function. Its last place stands
   * for the functions of windows that there are not, at the edges of the grid.
   *
   * Splines are averaged over domains either as a whole, or their derivatives
   * alone, each in its direction, with values at the points in the others. The
   * first kind balances loads at points that are no quadrature, but the mass
   * matrix that goes with it couples functions of neighbouring windows. The
   * second one goes with the mass matrix of the points.
   *
   * A cell *reaches* its neighbours if all functions of its window are stable
   * or extended. The others are determined by nothing but the points in their
   * own cells, and points in cells that do not reach see no neighbour.
   */
  template <int dim>
  class CellWindows
  {
  public:
    /**
     * Collective. The space, of one component, is kept by reference. No cell
     * reaches its neighbours before update(). @p averages_values tells whether
     * splines are averaged as a whole.
     */
    void
    reinit(const SplineSpace<dim> &space, const bool averages_values);

    bool
    averages_values() const
    {
      return with_values;
    }

    /**
     * Collective. Find the cells that reach their neighbours.
     */
    void
    update(const Extension<dim> &extension);

    /**
     * Let all cells reach their neighbours, where no function is extended.
     */
    void
    reach_all()
    {
      std::fill(reaching.begin(), reaching.end(), 1);
    }

    bool
    reaches(const unsigned int cell) const
    {
      return reaching[cell];
    }

    /**
     * Places in the buffer of the functions of the window of an owned cell, in
     * lexicographic order.
     */
    const unsigned int *
    functions(const unsigned int cell) const
    {
      return places.data() + std::size_t(cell) * n_in_window;
    }

    /**
     * Places of the buffer.
     */
    std::size_t
    n_places() const
    {
      return buffer_vector.locally_owned_size() +
             buffer_vector.get_partitioner()->n_ghost_indices() + 1;
    }

    /**
     * Collective. Copy the coefficients of a vector into the buffer from @p
     * numbers on, one for each place, @p stride apart.
     */
    void
    read(const VectorType  &vector,
         double            *numbers,
         const unsigned int stride) const;

    /**
     * The same for the components of a field, into a buffer that has nothing
     * else and is resized.
     */
    void
    read(const VectorField<dim> &field, std::vector<double> &buffer) const;

    /**
     * Collective. Add what the buffers of all processes have of each function
     * to the vector.
     */
    void
    add_to(VectorType        &vector,
           const double      *numbers,
           const unsigned int stride) const;

    void
    add_to(VectorField<dim> &field, const std::vector<double> &buffer) const;

  private:
    const SplineSpace<dim>    *spline_space = nullptr;
    unsigned int               n_in_window  = 0;
    bool                       with_values  = false;
    std::vector<unsigned int>  places;
    std::vector<unsigned char> reaching;
    mutable VectorType         buffer_vector;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/vector_field.h>
#include <greville/spline/extension.h>

#include <algorithm>

namespace greville
{
  /**
   * The *window* of a cell: the @f$ (p + 3)^\text{dim} @f$ functions of a space
   * that do not vanish on the cell or on one of its neighbours (by a face, an
   * edge or a vertex). These functions can be nonzero on a point's domain that
   * extends over the faces of its cell.
   *
   * Coefficients lie in a buffer, function by function. Its last place stands
   * for functions of a window that lie outside the grid.
   *
   * Either the splines themselves are averaged over the domains, or only their
   * derivatives, each in its own direction, with point values in the other
   * directions. The first kind balances loads even if the points are no
   * quadrature rule, but its mass matrix couples functions of neighbouring
   * windows. The second kind works with the mass matrix of the points.
   *
   * A cell *reaches* its neighbours if all functions of its window are stable
   * or extended. Other functions are determined only by the points in their own
   * cells; points in cells that do not reach use the functions of their own
   * cell only.
   */
  template <int dim>
  class CellWindows
  {
  public:
    /// Collective. The space is kept by reference. No cell reaches its
    /// neighbours before update(). @p averages_values selects averages of the
    /// splines themselves.
    void
    reinit(const SplineSpace<dim> &space, const bool averages_values);

    bool
    averages_values() const
    {
      return with_values;
    }

    /// Collective. Find the cells that reach their neighbours.
    void
    update(const Extension<dim> &extension);

    /// Let all cells reach their neighbours, if no function is extended.
    void
    reach_all_neighbors()
    {
      std::fill(reaching.begin(), reaching.end(), 1);
    }

    bool
    reaches(const unsigned int cell) const
    {
      return reaching[cell];
    }

    /// Return the buffer places of the functions of an owned cell's window, in
    /// lexicographic order.
    const unsigned int *
    functions(const unsigned int cell) const
    {
      return buffer_places.data() + std::size_t(cell) * n_in_window;
    }

    /// Return the number of places in the buffer.
    std::size_t
    n_places() const
    {
      return buffer_vector.locally_owned_size() +
             buffer_vector.get_partitioner()->n_ghost_indices() + 1;
    }

    /// Collective. Copy the coefficients of a vector into the buffer
    /// @p numbers, one for each place, @p stride apart.
    void
    read(const VectorType  &vector,
         double            *numbers,
         const unsigned int stride) const;

    /// Collective. Copy the components of a field into a buffer, which is
    /// resized.
    void
    read(const VectorField<dim> &field, std::vector<double> &buffer) const;

    /// Collective. Add the entries of each function in the buffers of all
    /// processes to the vector.
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
    std::vector<unsigned int>  buffer_places;
    std::vector<unsigned char> reaching;
    mutable VectorType         buffer_vector;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_constraints_h
#define greville_steps_constraints_h

#include <greville/boundary/held_functions.h>

#include <utility>

namespace greville
{
  /**
   * Orthonormal directions, none of them an axis, along which an owned function
   * is constrained.
   */
  template <int dim>
  struct ConstrainedDirections
  {
    unsigned int                            function = 0, n = 0;
    std::array<dealii::Tensor<1, dim>, dim> unit;

    dealii::Tensor<1, dim>
    part_along(const dealii::Tensor<1, dim> &vector) const
    {
      dealii::Tensor<1, dim> part;
      for (unsigned int k = 0; k < n; ++k)
        part += (vector * unit[k]) * unit[k];
      return part;
    }

    bool
    operator==(const ConstrainedDirections &other) const
    {
      return function == other.function && n == other.n && unit == other.unit;
    }
  };



  /**
   * What is constrained of a velocity besides what walls constrain: of each
   * owned function components, as bits, and vectors of any length along which
   * the velocity is given while it is free across them.
   */
  template <int dim>
  struct Constraints
  {
    std::vector<unsigned char>                                   components;
    std::vector<std::pair<unsigned int, dealii::Tensor<1, dim>>> directions;

    /**
     * None at any of @p n owned functions.
     */
    void
    clear(const unsigned int n)
    {
      components.assign(n, 0);
      directions.clear();
    }

    /**
     * Add to the components the directions that are axes. Returns what is left
     * of the others in the space of components that are free, by function:
     * neither in components nor in those that are @p held already.
     */
    std::vector<ConstrainedDirections<dim>>
    reduce(const std::vector<unsigned char> &held);
  };



  /**
   * The coefficients of a field at an owned function.
   */
  template <int dim>
  dealii::Tensor<1, dim>
  values_at(const VectorField<dim> &field, const unsigned int function)
  {
    dealii::Tensor<1, dim> values;
    for (unsigned int c = 0; c < dim; ++c)
      values[c] = field[c].local_element(function);
    return values;
  }
} // namespace greville

#endif

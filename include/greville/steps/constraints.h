// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/boundary/constrained_functions.h>

#include <utility>

namespace greville
{
  /// Orthonormal directions along which an owned function is constrained. None
  /// of them is an axis.
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



  /// Constraints of a velocity in addition to walls. Each owned function has
  /// constrained components, as bits, and vectors of any length. The velocity
  /// along a vector is prescribed; other directions are free.
  template <int dim>
  struct Constraints
  {
    std::vector<unsigned char>                                   components;
    std::vector<std::pair<unsigned int, dealii::Tensor<1, dim>>> directions;

    /// Remove the constraints of all @p n owned functions.
    void
    clear(const unsigned int n)
    {
      components.assign(n, 0);
      directions.clear();
    }

    /// Move directions along axes to the components. Returns the remaining
    /// directions by function. They are orthonormal in the space of components
    /// that neither this object nor @p constrained constrains.
    std::vector<ConstrainedDirections<dim>>
    reduce(const std::vector<unsigned char> &constrained);
  };



  /// Return the coefficients of a field at an owned function.
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

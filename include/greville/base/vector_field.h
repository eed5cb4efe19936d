// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_vector_field_h
#define greville_base_vector_field_h

#include <greville/base/compatibility.h>

#include <array>

namespace greville
{
  /**
   * A vector field of the grid: one vector of coefficients per component.
   */
  template <int dim>
  using VectorField = std::array<VectorType, dim>;
} // namespace greville

#endif

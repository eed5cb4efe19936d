// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/compatibility.h>

#include <array>

namespace greville
{
  /// A vector field of the grid: one vector of coefficients per component.
  template <int dim>
  using VectorField = std::array<VectorType, dim>;

  /// Return the components of fields, one after another.
  template <typename Vector, typename Field>
  std::vector<Vector *>
  columns_of(const std::vector<Field *> &fields)
  {
    std::vector<Vector *> result;
    for (Field *field : fields)
      for (Vector &component : *field)
        result.push_back(&component);
    return result;
  }
} // namespace greville

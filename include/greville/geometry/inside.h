// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/placement.h>

#include <functional>

namespace greville
{
  /// Return a function that tells whether a position (m) is inside the formula
  /// or file of @p placement. Throws like place_points().
  template <int dim>
  std::function<bool(const dealii::Point<dim> &)>
  make_inside(const PointPlacement   &placement,
              const std::string      &section,
              const SplineSpace<dim> &space);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/point.h>

#include <greville/base/expression.h>

#include <string>

namespace greville
{
  /// Return all shapes and operators on shapes, separated by '|'.
  std::string
  shape_names();

  /**
   * The inside of a body, given by a formula of x, y (and z) that is true (not
   * 0) inside. In addition to the language of Expression, formulas may contain
   * the shapes
   *   box(x0, y0, [z0,] x1, y1, [z1]), ball(x, y, [z,] radius),
   *   cylinder(x0, y0, z0, x1, y1, z1, radius) with its axis from the first to
   *   the second point (in 3D),
   *   half_space(n_x, n_y, [n_z,] c): n . x <= c,
   *   level_set(f): where the formula f is negative,
   * combined by union(a, b, ...), intersection(a, b, ...) and difference(a, b,
   * ...): in a and not in b, ...
   */
  template <int dim>
  class Shape
  {
  public:
    /// Throws dealii::ExcMessage if @p formula is invalid. A formula that
    /// @p moves may contain the time t, s.
    Shape(const std::string &formula,
          const std::string &parameter,
          const bool         moves = false);

    /// Return whether a point is inside, of a shape that moves at the time
    /// @p t.
    bool
    contains(const dealii::Point<dim> &x, const double t = 0.) const;

  private:
    Expression expression;
    bool       moves;
  };
} // namespace greville

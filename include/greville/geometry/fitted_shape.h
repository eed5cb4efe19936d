// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/level_set.h>
#include <greville/geometry/shape.h>
#include <greville/spline/lattice.h>

#include <array>

namespace greville
{
  /// The part of a cell inside a shape, in coordinates of the cell, which are
  /// in [0, 1].
  template <int dim>
  struct CellPart
  {
    /// True if the whole cell is inside; there are no points then.
    bool                                   is_full = false;
    std::vector<WeightedPoint<dim>>        points;
    std::vector<WeightedSurfacePoint<dim>> surface;
  };

  /// Base class of shapes that can compute their boundary within a cell.
  template <int dim>
  class FittedShape
  {
  public:
    virtual ~FittedShape() = default;

    /// Return points that integrate over the part of a cell inside the shape,
    /// and over the boundary in the cell, with order 2 n or higher where the
    /// boundary is smooth. Boundary in a face belongs to the cell on its inner
    /// side. The cell may be outside of the grid, next to it.
    virtual CellPart<dim>
    cut(const CellBox<dim> &cell, const unsigned int n) const = 0;

    virtual bool
    contains(const dealii::Point<dim> &x) const = 0;
  };

  /// A shape of level sets. Parts between planes, and parts next to one curved
  /// surface, are exact up to the quadrature. Where curved surfaces meet other
  /// surfaces, cells are divided, and the smallest parts are bounded by planes.
  template <int dim>
  class LevelSetShape : public FittedShape<dim>
  {
  public:
    LevelSetShape(const std::string &formula, const std::string &parameter);

    CellPart<dim>
    cut(const CellBox<dim> &cell, const unsigned int n) const override;

    bool
    contains(const dealii::Point<dim> &x) const override
    {
      return shape.contains(x);
    }

  private:
    Shape<dim>     shape;
    ShapeTree<dim> tree;
  };
} // namespace greville

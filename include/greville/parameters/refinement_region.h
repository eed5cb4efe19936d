// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/shape.h>
#include <greville/parameters/grid_parameters.h>

#include <optional>

namespace greville
{
  /// The place of a region in which cells are refined: the shape of
  /// RefinementParameters, or the whole grid if this is empty, and of it the
  /// part near surfaces if a distance is given.
  template <int dim>
  class RefinementRegion
  {
  public:
    /// The shape of a region that @p moves may contain the time. Throws
    /// dealii::ExcMessage for an invalid shape.
    RefinementRegion(const RefinementParameters &region,
                     const std::string          &name,
                     const bool                  moves,
                     const IsNearSurface<dim>   &is_near = {});

    /// Return whether the @p box of a cell of a level contains a smallest cell
    /// of the region whose centre is in the shape at a time, s, and which is
    /// near a surface.
    bool
    contains(const unsigned int  level,
             const CellBox<dim> &box,
             const double        time) const;

  private:
    unsigned int              n_levels;
    double                    distance; // m
    std::optional<Shape<dim>> shape;
    IsNearSurface<dim>        is_near;
  };
} // namespace greville

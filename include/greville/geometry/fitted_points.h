// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/fitted_shape.h>
#include <greville/geometry/placement.h>

#include <memory>

namespace greville
{
  /// Return the shape of the formula or file of @p placement. Throws like
  /// place_points(), and also if the position of the surface is unknown.
  template <int dim>
  std::unique_ptr<FittedShape<dim>>
  make_fitted_shape(const PointPlacement   &placement,
                    const std::string      &section,
                    const SplineSpace<dim> &space);

  /// Place points as place_points(), but fitted to the boundary: with n points
  /// per direction, they integrate over the inside with order 2 n. Volumes are
  /// positive. Cells of which less than 1e-10 is inside have no points.
  template <int dim>
  std::vector<PlacedPoint<dim>>
  place_fitted_points(const PointPlacement   &placement,
                      const std::string      &section,
                      const SplineSpace<dim> &space);



  /// A point on the boundary of a shape, with the outward normal and its share
  /// of the area (in 2D length).
  template <int dim>
  struct SurfacePoint
  {
    dealii::Point<dim>     x;
    dealii::Tensor<1, dim> normal;
    double                 area;
    /// The cell on the inner side, among owned cells.
    unsigned int cell;
    /// The id, which does not depend on the number of processes.
    std::uint64_t id;
  };

  /// Return points on the boundary of a shape in the owned cells, with as many
  /// points per direction as place_fitted_points(). Sides along which the grid
  /// clips the shape are not part of the boundary. Throws like place_points().
  template <int dim>
  std::vector<SurfacePoint<dim>>
  place_surface_points(const PointPlacement   &placement,
                       const std::string      &section,
                       const SplineSpace<dim> &space);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_fitted_points_h
#define greville_geometry_fitted_points_h

#include <greville/geometry/fitted_shape.h>
#include <greville/geometry/placement.h>

#include <memory>

namespace greville
{
  /**
   * The shape of the formula or file of @p placement. Throws as
   * place_points(), and where it is unknown where the surface is.
   */
  template <int dim>
  std::unique_ptr<FittedShape<dim>>
  make_fitted_shape(const PointPlacement   &placement,
                    const std::string      &section,
                    const SplineSpace<dim> &space);

  /**
   * place_points() for points that follow the boundary: with n points per
   * direction they integrate over what is inside with order 2 n. Volumes are
   * positive. Cells of which less than 1e-10 is inside have no points.
   */
  template <int dim>
  std::vector<PlacedPoint<dim>>
  place_fitted_points(const PointPlacement   &placement,
                      const std::string      &section,
                      const SplineSpace<dim> &space);



  /**
   * A point of the boundary of a shape, with the normal that points outwards
   * and the area (in 2D length) that belongs to it.
   */
  template <int dim>
  struct SurfacePoint
  {
    dealii::Point<dim>     x;
    dealii::Tensor<1, dim> normal;
    double                 area;
    /// Among owned cells: the one on the inner side.
    unsigned int cell;
    /// The same on any number of processes.
    std::uint64_t id;
  };

  /**
   * Points on the boundary of a shape in the owned cells, as many per direction
   * as place_fitted_points() has. Where the grid clips the shape there is no
   * boundary. Throws as place_points().
   */
  template <int dim>
  std::vector<SurfacePoint<dim>>
  place_surface_points(const PointPlacement   &placement,
                       const std::string      &section,
                       const SplineSpace<dim> &space);
} // namespace greville

#endif

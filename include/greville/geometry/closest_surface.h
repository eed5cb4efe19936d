// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_closest_surface_h
#define greville_geometry_closest_surface_h

#include <greville/geometry/surface_shape.h>

#include <memory>
#include <optional>

namespace greville
{
  /**
   * The point of a surface that is closest to a place.
   */
  template <int dim>
  struct ClosestPoint
  {
    dealii::Point<dim> point;
    /// Outwards, of length 1. At edges and corners, the direction from the
    /// closest point to the place, or the opposite inside of the body.
    dealii::Tensor<1, dim> normal;
    /// Negative inside of the body (m).
    double distance = 0.;
  };



  /**
   * The surface of a rigid body, which does not move: its distance from places.
   * Edges and corners are as sharp as they are given.
   *
   * Searches use memory of the object and formulas of muParser, so that an
   * object is not for several threads at a time. Results do not depend on
   * earlier ones.
   */
  template <int dim>
  class ClosestSurface
  {
  public:
    virtual ~ClosestSurface() = default;

    /**
     * The closest point, nothing where the surface is further away than
     * @p within (m), which may be infinite.
     */
    virtual std::optional<ClosestPoint<dim>>
    closest(const dealii::Point<dim> &x, const double within) const = 0;

    /**
     * A box around the body, which may be larger by some hundredths, and
     * infinite in some directions.
     */
    virtual dealii::BoundingBox<dim>
    box() const = 0;

    /**
     * Facets for pictures, as a ClosedSurface where the body lies inside of
     * @p clip. Meshes are as they were given. Shapes of formulas are cut by a
     * lattice of about @p size (m) inside of @p clip, which has to be finite:
     * the corners of facets are on the surface, edges are cut off.
     */
    virtual ClosedSurface<dim>
    facets(const double size, const dealii::BoundingBox<dim> &clip) const = 0;
  };



  /**
   * The surface of a body from a @p formula that ShapeTree takes. The closest
   * point is one of the projections of x onto single level sets, onto curves in
   * which two of them meet, or is a corner; of those that separate the inside
   * from the outside it is the nearest. For planes, balls and cylinders all
   * projections are found, so that the distance is exact. For formulas they are
   * found by Newton's method from x, from points all over the surface where the
   * box around the body is finite, and, where samples in the ball around x that
   * reaches to the nearest point lie on the other side of the surface, from
   * there. Formulas have to be smooth where they are zero; derivatives are
   * differences of sixth order.
   *
   * Throws dealii::ExcMessage, which names the @p parameter, where the formula
   * is wrong.
   */
  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(const std::string &formula,
                       const std::string &parameter);



  /**
   * The surface of a body from facets, such as read_surface() returns. Facets
   * are found in an R-tree of boxes. The side follows from the sum of the
   * normals of all facets at the closest point, which are weighted by their
   * angles there
   * (@ref Baerentzen2005 "B&aelig;rentzen and Aan&aelig;s, 2005").
   */
  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(ClosedSurface<dim> surface);
} // namespace greville

#endif

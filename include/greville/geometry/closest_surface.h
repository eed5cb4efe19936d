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
   * Searches use memory of the object and formulas, so that an
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
     * Return whether the place is inside of the body.
     */
    virtual bool
    contains(const dealii::Point<dim> &x) const = 0;

    /**
     * A box around the body, which may be larger by a quarter, or infinite
     * where the end of the body is not known. Throws dealii::ExcMessage for a
     * shape that certainly is empty.
     */
    virtual dealii::BoundingBox<dim>
    box() const = 0;

    /**
     * A closed mesh of the body: its facets where it is given by some; of a
     * formula dual_contours(), of what is in the box @p region where the end of
     * the body is not known.
     */
    virtual ClosedSurface<dim>
    mesh(const dealii::BoundingBox<dim> &region) const = 0;
  };



  /**
   * The surface of a body from a @p formula that ShapeTree takes. The closest
   * point is the projection of x onto a single level set, or onto points that
   * two or three of them have in common; of those with the inside on one side
   * and the outside on the other it is the nearest.
   *
   * Projections onto single planes, balls and cylinders are closed forms. All
   * others are found by Newton's method across the level sets and steps along
   * them as long as Barzilai and Borwein's. They start from x for a formula,
   * and from a projection onto a curved level set for edges and corners. So
   * they find a closest point where x is nearer to it than the radius of
   * curvature and other parts of the same level sets or edges; elsewhere the
   * distance may be too large, or nothing may be found.
   *
   * Formulas have to be defined, and smooth where they are zero, within three
   * times @p within; their derivatives are differences of sixth order over
   * hundredths of it. The box of a formula is infinite.
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
  make_closest_surface(const ClosedSurface<dim> &surface);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/surface_shape.h>

#include <memory>
#include <optional>

namespace greville
{
  /// The point of a surface that is closest to a given position.
  template <int dim>
  struct ClosestPoint
  {
    dealii::Point<dim> point;
    /// The outward unit normal. At edges and corners, it is the direction from
    /// the closest point to the given position, or its opposite inside the
    /// body.
    dealii::Tensor<1, dim> normal;
    /// The distance from the surface, negative inside the body (m).
    double distance = 0.;
  };



  /**
   * Base class of surfaces of rigid bodies in their initial position, to find
   * closest points. Edges and corners are exactly as sharp as given.
   *
   * Searches use memory of the object and of formulas, so an object is not
   * thread-safe. Results do not depend on earlier searches.
   */
  template <int dim>
  class ClosestSurface
  {
  public:
    virtual ~ClosestSurface() = default;

    /// Return the closest point, or nothing if the surface is farther away than
    /// @p within (m), which may be infinite.
    virtual std::optional<ClosestPoint<dim>>
    closest(const dealii::Point<dim> &x, const double within) const = 0;

    virtual bool
    contains(const dealii::Point<dim> &x) const = 0;

    /// Return a box around the body. It may be up to a quarter too large, or
    /// infinite if the extent of the body is not known. Throws
    /// dealii::ExcMessage for a shape that is certainly empty.
    virtual dealii::BoundingBox<dim>
    box() const = 0;

    /// Return a closed mesh of the body: its facets if it is given by facets,
    /// otherwise dual_contours() of its formula. If the extent of the body is
    /// not known, the mesh is restricted to the box @p region.
    virtual ClosedSurface<dim>
    mesh(const dealii::BoundingBox<dim> &region) const = 0;
  };



  /**
   * Return the surface of a body from a @p formula for a ShapeTree. Candidates
   * for the closest point are the projections of x onto single level sets and
   * onto intersections of two or three of them; the result is the nearest
   * candidate with the inside on one side and the outside on the other.
   *
   * Projections onto single planes, balls and cylinders have closed forms. All
   * others are found by Newton's method across the level sets and steps of
   * Barzilai and Borwein's length along them. For a single formula, the
   * iteration starts from x; for edges and corners, it starts from a projection
   * onto a curved level set. It finds the closest point if x is nearer to it
   * than the radius of curvature and than other parts of the same level sets or
   * edges. Otherwise, the distance may be too large, or nothing may be found.
   *
   * Formulas must be defined, and smooth on their zero sets, within a distance
   * of three times @p within; their derivatives are differences of sixth order
   * over hundredths of @p within. The box of a formula is infinite.
   *
   * Throws dealii::ExcMessage with the name of the @p parameter if the formula
   * is invalid.
   */
  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(const std::string &formula,
                       const std::string &parameter);



  /// Return the surface of a body from facets, as returned by read_surface().
  /// Facets are found in an R-tree of boxes. The sum of the normals of all
  /// facets at the closest point, weighted by their angles there, determines
  /// the side (@ref Baerentzen2005 "B&aelig;rentzen and Aan&aelig;s, 2005").
  template <int dim>
  std::unique_ptr<ClosestSurface<dim>>
  make_closest_surface(const ClosedSurface<dim> &surface);
} // namespace greville

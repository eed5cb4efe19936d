// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/point.h>

#include <vector>

namespace greville
{
  template <int dim>
  struct WeightedPoint
  {
    dealii::Point<dim> x;
    double             weight;
  };

  /// A quadrature point of a surface: the weight is an area, the normal has
  /// length 1.
  template <int dim>
  struct WeightedSurfacePoint
  {
    dealii::Point<dim>     x;
    dealii::Tensor<1, dim> normal;
    double                 weight;
  };

  /// A plane of points with normal . x = offset. The normal has length 1.
  template <int dim>
  struct Plane
  {
    dealii::Tensor<1, dim> normal;
    double                 offset = 0.;

    double
    distance(const dealii::Point<dim> &x) const
    {
      return normal * x - offset;
    }
  };

  /// A convex polygon in a plane, given by its corners in order; in 2D a
  /// segment with two ends.
  template <int dim>
  using Facet = std::vector<dealii::Point<dim>>;

  /// Cut @p facet along a plane. Parts without extent are empty. Points closer
  /// to the plane than @p tolerance count as in it; a facet in the plane is
  /// @p below.
  template <int dim>
  void
  split_facet(const Facet<dim> &facet,
              const Plane<dim> &plane,
              const double      tolerance,
              Facet<dim>       &below,
              Facet<dim>       &above);

  /// Return the mean of the corners.
  template <int dim>
  dealii::Point<dim>
  center_of(const Facet<dim> &facet);

  /// Append points that integrate polynomials of degree 2 n - 1 over @p facet.
  template <int dim>
  void
  append_quadrature(const Facet<dim>                       &facet,
                    const dealii::Tensor<1, dim>           &normal,
                    const unsigned int                      n,
                    std::vector<WeightedSurfacePoint<dim>> &points);



  /// A convex polygon or polyhedron, stored as the facets around it. It is made
  /// from a box by cutting off parts along planes.
  template <int dim>
  class ConvexPart
  {
  public:
    ConvexPart() = default;

    ConvexPart(const dealii::BoundingBox<dim> &box);

    /// Compute the parts on both sides of @p plane and the part of the plane
    /// between them. Returns whether both parts have an extent; otherwise,
    /// nothing is computed. Corners closer to the plane than @p tolerance count
    /// as in it.
    bool
    split(const Plane<dim> &plane,
          const double      tolerance,
          ConvexPart       &below,
          ConvexPart       &above,
          Facet<dim>       &cut) const;

    /// Return some point inside.
    dealii::Point<dim>
    center() const;

    /// Append points that integrate polynomials of degree 2 n - 1, with
    /// positive weights.
    void
    append_quadrature(const unsigned int               n,
                      std::vector<WeightedPoint<dim>> &points) const;

  private:
    std::vector<Facet<dim>> facets;
  };
} // namespace greville

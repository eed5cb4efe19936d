// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_convex_part_h
#define greville_geometry_convex_part_h

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/point.h>

#include <vector>

namespace greville
{
  /**
   * A point of a quadrature.
   */
  template <int dim>
  struct WeightedPoint
  {
    dealii::Point<dim> x;
    double             weight;
  };

  /**
   * A point of a quadrature of a surface: the weight is an area, the normal
   * has length 1.
   */
  template <int dim>
  struct WeightedSurfacePoint
  {
    dealii::Point<dim>     x;
    dealii::Tensor<1, dim> normal;
    double                 weight;
  };

  /**
   * The points with normal . x = offset. The normal has length 1.
   */
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

  /**
   * A convex polygon in a plane, its corners one after the other; in 2D a
   * segment with two ends.
   */
  template <int dim>
  using Facet = std::vector<dealii::Point<dim>>;

  /**
   * Cut @p facet along a plane. Parts of no extent are empty; what lies closer
   * to the plane than @p tolerance is in it, and a facet in it is @p below.
   */
  template <int dim>
  void
  split_facet(const Facet<dim> &facet,
              const Plane<dim> &plane,
              const double      tolerance,
              Facet<dim>       &below,
              Facet<dim>       &above);

  /**
   * The mean of the corners.
   */
  template <int dim>
  dealii::Point<dim>
  center_of(const Facet<dim> &facet);

  /**
   * Append points that integrate polynomials of degree 2 n - 1 over @p facet.
   */
  template <int dim>
  void
  append_quadrature(const Facet<dim>                       &facet,
                    const dealii::Tensor<1, dim>           &normal,
                    const unsigned int                      n,
                    std::vector<WeightedSurfacePoint<dim>> &points);



  /**
   * A convex polygon or polyhedron, as the facets around it: a box from which
   * planes cut parts.
   */
  template <int dim>
  class ConvexPart
  {
  public:
    ConvexPart() = default;

    ConvexPart(const dealii::BoundingBox<dim> &box);

    /**
     * The parts on both sides of @p plane, and what they share: the part of
     * the plane inside. Returns whether both have an extent; else nothing is
     * made. Corners closer to the plane than @p tolerance are in it.
     */
    bool
    split(const Plane<dim> &plane,
          const double      tolerance,
          ConvexPart       &below,
          ConvexPart       &above,
          Facet<dim>       &cut) const;

    /**
     * Some point inside.
     */
    dealii::Point<dim>
    center() const;

    /**
     * Append points that integrate polynomials of degree 2 n - 1, with positive
     * weights.
     */
    void
    append_quadrature(const unsigned int               n,
                      std::vector<WeightedPoint<dim>> &points) const;

  private:
    std::vector<Facet<dim>> facets;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_surface_shape_h
#define greville_geometry_surface_shape_h

#include <greville/geometry/fitted_shape.h>

#include <memory>
#include <string>
#include <vector>

namespace greville
{
  template <int dim>
  class ClosestSurface;



  /**
   * A closed surface of triangles (in 2D segments), whose normals point
   * outwards: corners are counterclockwise when seen from outside, in 2D the
   * inside is on the left.
   */
  template <int dim>
  using ClosedSurface = std::vector<Facet<dim>>;

  /**
   * Read a surface whose coordinates are multiples of @p unit (m). In 3D a mesh
   * in a format that Assimp knows: STL, PLY, OBJ, ...; in 2D a CSV file with
   * the columns x, y and, where there are several polygons, loop: vertices one
   * after the other, in either sense; a polygon in another is a hole. Throws
   * dealii::ExcMessage, which names the @p parameter, where a mesh is not
   * closed or its normals do not point outwards.
   */
  template <int dim>
  ClosedSurface<dim>
  read_surface(const std::string &file,
               const std::string &parameter,
               const double       unit);



  /**
   * What is inside of a closed surface, on a lattice: cells are cut exactly.
   */
  template <int dim>
  class SurfaceShape : public FittedShape<dim>
  {
  public:
    SurfaceShape(ClosedSurface<dim> surface, const Lattice<dim> &lattice);

    ~SurfaceShape();

    CellPart<dim>
    cut(const CellBox<dim> &cell, const unsigned int n) const override;

    bool
    contains(const dealii::Point<dim> &x) const override;

  private:
    /**
     * A part of a facet, which may be too small to find its plane from it.
     */
    struct PlaneFacet
    {
      Facet<dim> facet;
      Plane<dim> plane;
    };

    /**
     * Sort facets by cells of the lattice and of a layer around it.
     */
    void
    sort_by_cells();

    template <typename Index>
    std::uint64_t
    cell_key(const Index &index) const;

    /**
     * What is left of a part of a cell that facets cut.
     */
    void
    cut_part(const ConvexPart<dim>           &part,
             std::vector<PlaneFacet>          facets,
             const CellBox<dim>              &cell,
             const unsigned int               n,
             std::vector<WeightedPoint<dim>> &points) const;

    ClosedSurface<dim>                                  surface;
    std::unique_ptr<ClosestSurface<dim>>                closest;
    Lattice<dim>                                        lattice;
    std::vector<std::pair<std::uint64_t, unsigned int>> by_cell;
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/fitted_shape.h>

#include <memory>
#include <string>
#include <vector>

namespace greville
{
  template <int dim>
  class ClosestSurface;



  /// A closed surface of triangles (in 2D segments) with outward normals.
  /// Corners are counterclockwise when seen from outside; in 2D, the inside is
  /// on the left.
  template <int dim>
  using ClosedSurface = std::vector<Facet<dim>>;

  /// Read a surface whose coordinates are multiples of @p unit (m). In 3D, the
  /// file is a mesh in a format of Assimp: STL, PLY, OBJ, ... In 2D, it is a
  /// CSV file with the columns x, y and, for several polygons, loop. It lists
  /// the vertices in order, in either sense; a polygon inside another one is a
  /// hole. Throws dealii::ExcMessage with the name of the @p parameter if a
  /// mesh is not closed or its normals do not point outwards.
  template <int dim>
  ClosedSurface<dim>
  read_surface(const std::string &file,
               const std::string &parameter,
               const double       unit);

  template <>
  ClosedSurface<2>
  read_surface<2>(const std::string &file,
                  const std::string &parameter,
                  const double       unit);

  template <>
  ClosedSurface<3>
  read_surface<3>(const std::string &file,
                  const std::string &parameter,
                  const double       unit);



  /// The inside of a closed surface on a lattice. Cells are cut exactly.
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
    /// A part of a facet with the plane of the facet, since the part may be too
    /// small to determine the plane.
    struct PlaneFacet
    {
      Facet<dim> facet;
      Plane<dim> plane;
    };

    /// Sort facets by cells of the lattice and of a layer around it.
    void
    sort_by_cells();

    template <typename Index>
    std::uint64_t
    cell_key(const Index &index) const;

    /// Cut a part of a cell by facets and keep the inside.
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

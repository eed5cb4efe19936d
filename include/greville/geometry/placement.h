// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_placement_h
#define greville_geometry_placement_h

#include <greville/base/parameters.h>
#include <greville/spline/spline_space.h>

#include <string>
#include <vector>

namespace greville
{
  /// The parameter 'Placement'.
  enum class Placement
  {
    equidistant,
    gauss,
    fitted,
    fitted_lattice
  };

  inline const Choices<Placement> placements = {
    {Placement::equidistant, "equidistant"},
    {Placement::gauss, "Gauss"},
    {Placement::fitted, "fitted"},
    {Placement::fitted_lattice, "fitted lattice"}};



  /**
   * How a shape is filled with points, see the parameters of the same names.
   */
  struct PointPlacement
  {
    std::string               shape;
    std::string               shape_file;
    double                    shape_file_unit      = 1.;
    bool                      clip                 = false;
    std::vector<unsigned int> points_per_direction = {2};
    Placement                 placement            = Placement::equidistant;
    double                    jitter               = 0.;
    unsigned int              seed                 = 1;
  };



  /**
   * A point before it gets the numbers of its material.
   */
  template <int dim>
  struct PlacedPoint
  {
    dealii::Point<dim> x;
    /// Where the shape has the point: x, or a period beyond a periodic wall.
    dealii::Point<dim> image;
    double             volume;
    std::uint64_t      id;
    unsigned int       cell;
  };



  /**
   * The number of points of a cell in each direction.
   */
  template <int dim>
  MultiIndex<dim>
  points_of_cell(const PointPlacement &placement, const std::string &section);

  /**
   * The points of a shape on the owned cells. They, and their ids, do not
   * depend on the number of processes. Throws dealii::ExcMessage, which names
   * the @p section, for wrong formulas and a shape that sticks out of the grid.
   * What sticks out through a periodic wall comes in on the other side, but for
   * fitted points.
   */
  template <int dim>
  std::vector<PlacedPoint<dim>>
  place_points(const PointPlacement   &placement,
               const std::string      &section,
               const SplineSpace<dim> &space);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

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



  /// The method that fills a shape with points, see the parameters of the same
  /// names.
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



  /// A placed point, without the state variables of its material.
  template <int dim>
  struct PlacedPoint
  {
    dealii::Point<dim> x;
    /// The position in the shape. It is x, or differs from x by a period if it
    /// is beyond a periodic wall.
    dealii::Point<dim> image;
    double             volume;
    std::uint64_t      id;
    unsigned int       cell;
  };



  template <int dim>
  MultiIndex<dim>
  points_of_cell(const PointPlacement &placement, const std::string &section);

  /// Return the points of a shape in the owned cells. Points and ids do not
  /// depend on the number of processes. Parts beyond a periodic wall enter on
  /// the opposite side, except for fitted points. Throws dealii::ExcMessage
  /// with the name of the @p section for invalid formulas and for a shape that
  /// extends beyond the grid.
  template <int dim>
  std::vector<PlacedPoint<dim>>
  place_points(const PointPlacement   &placement,
               const std::string      &section,
               const SplineSpace<dim> &space);
} // namespace greville

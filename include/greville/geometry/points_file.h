// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/geometry/placement.h>

#include <string>
#include <vector>

namespace greville
{
  /// The points of a file, with further numbers besides positions.
  template <int dim>
  struct PointsOfFile
  {
    std::vector<PlacedPoint<dim>> points;
    /// The names of further numbers, and the numbers, point by point.
    std::vector<std::string> names;
    std::vector<double>      values;

    /// Return the position of a name among the numbers of a point, or -1.
    int
    find(const std::string &name) const;

    double
    value(const std::size_t point, const int place) const
    {
      return values[point * names.size() + place];
    }
  };



  /**
   * Read the points of a CSV file (.csv, .txt, .dat) in the owned cells,
   * numbered in the order of the file. A volume is taken from the column
   * volume, or from mass over density (columns, or @p density). Further numbers
   * are read in complete groups of names in @p wanted. Points are assigned to
   * cells by their positions or, if @p at_reference, by the initial positions
   * in the file.
   *
   * Throws like place_points(), and also if a point is outside the grid or
   * coincides with another point, if volumes are larger than the grid, if the
   * columns mass, volume and density contradict each other, if the density is
   * more than a thousand times larger or smaller than @p density, or if a point
   * of an axisymmetric body is on the axis.
   */
  template <int dim>
  PointsOfFile<dim>
  points_of_file(const std::string                           &file,
                 const std::string                           &section,
                 const double                                 density,
                 const std::vector<std::vector<std::string>> &wanted,
                 const bool                                   at_reference,
                 const bool                                   is_axisymmetric,
                 const SplineSpace<dim>                      &space);

  /// Return, for all points at @p x in the file of points_of_file(), the file,
  /// parameter and line, as "...: " for messages.
  template <int dim>
  std::vector<std::string>
  find_in_points_file(const std::string        &file,
                      const std::string        &section,
                      const dealii::Point<dim> &x);
} // namespace greville

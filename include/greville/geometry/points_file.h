// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_geometry_points_file_h
#define greville_geometry_points_file_h

#include <greville/geometry/placement.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * Points of a file, and what it says of them beyond their places.
   */
  template <int dim>
  struct PointsOfFile
  {
    std::vector<PlacedPoint<dim>> points;
    /// The names of further numbers, and these, point by point.
    std::vector<std::string> names;
    std::vector<double>      values;

    /**
     * Where the number of a name stands among those of a point, or -1.
     */
    int
    find(const std::string &name) const;

    double
    value(const std::size_t point, const int place) const
    {
      return values[point * names.size() + place];
    }
  };



  /**
   * The points of a CSV file (.csv, .txt, .dat) on the owned cells, numbered in
   * its order; @p body is the number of the body whose points are wanted
   * (column body), or negative. A volume comes from the column volume, or as
   * mass over density (columns, or
   * @p density). Of the further numbers, groups are complete: @p wanted has the
   * names of each. The cells are those of positions, or, with @p at_reference,
   * of the initial positions that are in the file.
   *
   * Throws as place_points(), and where a point lies outside of the grid or in
   * the place of another one, where volumes are larger than the grid, where the
   * columns mass, volume and density contradict each other, where the
   * density is more than a thousand times larger or smaller than @p density, or
   * where a point of an axisymmetric body lies on the axis.
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

  /**
   * For messages: file, parameter and line of all points at @p x in the file of
   * points_of_file(), "...: " each.
   */
  template <int dim>
  std::vector<std::string>
  find_in_points_file(const std::string        &file,
                      const std::string        &section,
                      const dealii::Point<dim> &x);
} // namespace greville

#endif

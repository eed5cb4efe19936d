// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/expression.h>
#include <greville/particles/points_file.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * The columns of a file that are wanted.
     */
    struct Columns
    {
      std::vector<int> coordinates, further, reference, displacement;
      int              volume = -1, mass = -1, density = -1, body = -1;
    };
  } // namespace



  template <int dim>
  int
  PointsOfFile<dim>::find(const std::string &name) const
  {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : found - names.begin();
  }



  template <int dim>
  PointsOfFile<dim>
  points_of_file(const std::string                           &file,
                 const std::string                           &section,
                 const int                                    body,
                 const double                                 density,
                 const std::vector<std::vector<std::string>> &wanted,
                 const bool                                   at_reference,
                 const SplineSpace<dim>                      &space)
  {
    const auto       &lattice = space.lattice();
    PointsOfFile<dim> result;
    Columns           columns;
    bool              has_header = false;
    std::uint64_t     id         = 0;

    const auto read_header = [&](const std::vector<std::string> &names,
                                 const std::string              &where,
                                 const std::string              &text) {
      const auto find = [&](const std::string &name) {
        const auto found = std::find(names.begin(), names.end(), name);
        return found == names.end() ? -1 : int(found - names.begin());
      };
      // All of a group or none of it.
      const auto find_group = [&](const std::vector<std::string> &group) {
        std::vector<int> places;
        std::string      there, missing;
        for (const std::string &name : group)
          {
            places.push_back(find(name));
            (places.back() < 0 ? missing : there) = name;
          }
        AssertThrow(there.empty() || missing.empty(),
                    ExcMessage(where + "there is a column '" + there +
                               "', but no '" + missing + "' in <" + text +
                               ">."));
        return missing.empty() ? places : std::vector<int>();
      };
      Columns now;
      for (const std::string &name : coordinate_names<dim>())
        {
          now.coordinates.push_back(find(name));
          AssertThrow(now.coordinates.back() >= 0,
                      ExcMessage(where + "there is no column '" + name +
                                 "' in <" + text + ">."));
        }
      now.volume  = find("volume");
      now.mass    = find("mass");
      now.density = find("density");
      AssertThrow(now.volume >= 0 || now.mass >= 0,
                  ExcMessage(where + "there is no column 'volume' in <" + text +
                             ">, and no 'mass' to find it from."));
      now.body = find("body");
      AssertThrow(body < 0 || now.body >= 0,
                  ExcMessage(where + "there is no column 'body' in <" + text +
                             ">, but the parameter '" + section +
                             "/Body in points file' is " + text_of(body) +
                             "."));
      const auto vector = [&](const std::string &name) {
        std::vector<std::string> group;
        for (const std::string &axis : coordinate_names<dim>())
          group.push_back(name + "_" + axis);
        return group;
      };
      now.reference    = find_group(vector("reference"));
      now.displacement = find_group(vector("displacement"));
      std::vector<std::string> further;
      if (now.mass >= 0 || now.density >= 0)
        further.push_back("mass");
      const bool has_reference =
        !now.reference.empty() || !now.displacement.empty();
      for (const std::string &name : vector("reference"))
        if (has_reference)
          further.push_back(name);
      for (const auto &group : wanted)
        {
          const auto places = find_group(group);
          now.further.insert(now.further.end(), places.begin(), places.end());
          if (!places.empty())
            further.insert(further.end(), group.begin(), group.end());
        }
      AssertThrow(!has_header || further == result.names,
                  ExcMessage(where + "the arrays <" +
                             boost::algorithm::join(further, ", ") +
                             "> are not those of the pieces before, <" +
                             boost::algorithm::join(result.names, ", ") +
                             ">."));
      has_header   = true;
      result.names = further;
      columns      = now;
    };

    read_point_rows(
      file, section + "/Points file", read_header, [&](const PointRow &row) {
        if (body >= 0 && row.number(columns.body) != body)
          return;
        const auto positive = [&](const int column, const char *name) {
          const double value = row.number(column);
          AssertThrow(value > 0.,
                      ExcMessage(row.where + "the " + name +
                                 " has to be positive in <" + row.text + ">."));
          return value;
        };
        PlacedPoint<dim> point;
        for (unsigned int d = 0; d < dim; ++d)
          point.x[d] = row.number(columns.coordinates[d]);
        const double rho =
          columns.density >= 0 ? positive(columns.density, "density") : density;
        point.volume     = columns.volume >= 0
                             ? positive(columns.volume, "volume")
                             : positive(columns.mass, "mass") / rho;
        point.id         = id++;
        Point<dim> place = point.x, reference = point.x;
        for (unsigned int d = 0; d < dim; ++d)
          if (!columns.reference.empty())
            reference[d] = row.number(columns.reference[d]);
          else if (!columns.displacement.empty())
            reference[d] -= row.number(columns.displacement[d]);
        if (at_reference)
          place = reference;
        for (unsigned int d = 0; d < dim; ++d)
          AssertThrow(place[d] >= lattice.lower(d) &&
                        place[d] <= lattice.upper(d),
                      ExcMessage(row.where + "the point (" + text_of(place) +
                                 ") m lies outside of the grid."));
        const auto position =
          lexicographic<dim>(lattice.find_cell(place), lattice.n_cells());
        const auto &cells = space.owned_cells();
        const auto  found =
          std::lower_bound(cells.begin(), cells.end(), position);
        if (found == cells.end() || *found != position)
          return;
        point.cell  = found - cells.begin();
        point.image = point.x;
        result.points.push_back(point);
        if (columns.mass >= 0)
          result.values.push_back(positive(columns.mass, "mass"));
        else if (columns.density >= 0)
          result.values.push_back(rho * point.volume);
        for (unsigned int d = 0; d < dim; ++d)
          if (!columns.reference.empty() || !columns.displacement.empty())
            result.values.push_back(reference[d]);
        for (const int column : columns.further)
          result.values.push_back(row.number(column));
      });
    return result;
  }



  template struct PointsOfFile<2>;
  template struct PointsOfFile<3>;
  template decltype(points_of_file<2>) points_of_file<2>;
  template decltype(points_of_file<3>) points_of_file<3>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/csv.h>
#include <greville/base/errors.h>
#include <greville/base/expression.h>
#include <greville/geometry/points_file.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/case_conv.hpp>
#include <cmath>
#include <filesystem>

namespace greville
{
  using namespace dealii;

  namespace
  {
    struct Columns
    {
      std::vector<int> coordinates, further, reference, displacement;
      int              volume = -1, mass = -1, density = -1;
    };

    // Largest accepted deviations: the relative difference of redundant
    // columns, the ratio of densities of points and of their material, and the
    // fraction by which volumes exceed the grid.
    constexpr double largest_difference = 0.01, largest_ratio = 1e3,
                     largest_excess = 0.01;



    int
    place_of(const std::vector<std::string> &names, const std::string &name)
    {
      const auto found = std::find(names.begin(), names.end(), name);
      return found == names.end() ? -1 : int(found - names.begin());
    }



    /// Call read_csv() if the file name has a suitable extension.
    void
    read_points(const std::string                          &file,
                const std::string                          &section,
                const std::function<void(const CsvLine &)> &visit)
    {
      const std::string parameter = section + "/Points file";
      const std::string ending    = boost::algorithm::to_lower_copy(
        std::filesystem::path(file).extension().string());
      Require(ending.empty() || ending == ".csv" || ending == ".txt" ||
                ending == ".dat",
              "The file <" + file + "> of the parameter '" + parameter +
                "' ends with <" + ending +
                ">. Points come as CSV (.csv, .txt, .dat); "
                "scripts/points_to_csv converts files of VTK.");
      read_csv(file, parameter, visit);
    }



    template <int dim>
    void
    check_places(std::vector<const PlacedPoint<dim> *> points,
                 const std::string                    &file,
                 const std::string                    &section)
    {
      const auto key = [](const PlacedPoint<dim> *const p) {
        std::array<double, dim> result;
        for (unsigned int d = 0; d < dim; ++d)
          result[d] = p->x[d];
        return result;
      };
      std::sort(points.begin(),
                points.end(),
                [&](const auto *a, const auto *b) { return key(a) < key(b); });
      for (std::size_t k = 1; k < points.size(); ++k)
        if (points[k - 1]->x == points[k]->x)
          {
            const auto lines =
              find_in_points_file<dim>(file, section, points[k]->x);
            Require(false,
                    lines.back() + "the point (" + text_of(points[k]->x) +
                      ") m coincides with another one: there are " +
                      std::to_string(lines.size()) +
                      " points, the first one in " +
                      lines[0].substr(lines[0].rfind(", ") + 2) +
                      "their mass would be counted twice.");
          }
    }



    /// Reads the rows of a file, and keeps the points in owned cells.
    template <int dim>
    class PointsReader
    {
    public:
      PointsReader(const double                                 density,
                   const std::vector<std::vector<std::string>> &wanted,
                   const bool                                   at_reference,
                   const bool                                   is_axisymmetric,
                   const SplineSpace<dim>                      &space)
        : density(density)
        , wanted(wanted)
        , at_reference(at_reference)
        , is_axisymmetric(is_axisymmetric)
        , space(space)
        , volume_unit(dim == 3          ? "m^3"
                      : is_axisymmetric ? "m^3 per radian"
                                        : "m^2")
      {
        for (unsigned int d = 0; d < dim; ++d)
          grid_volume *= space.upper_corner()[d] - space.lower_corner()[d];
        if (is_axisymmetric)
          grid_volume *=
            0.5 * (space.lower_corner()[0] + space.upper_corner()[0]);
      }

      void
      read(const CsvLine &row)
      {
        if (row.is_header)
          read_header(row);
        else
          read_point(row);
      }

      /// Throw if all volumes together exceed the grid. @p where names the
      /// file.
      void
      check_sum(const std::string &where) const
      {
        Require(sum <= (1. + largest_excess) * grid_volume,
                where + ": the volumes (column '" +
                  (columns.volume >= 0 ? "volume" : "mass") + "') add up to " +
                  text_of(sum) + ' ' + volume_unit + ", but the grid has " +
                  text_of(grid_volume) + ". Is the unit right?");
      }

      PointsOfFile<dim> result;

    private:
      void
      read_header(const CsvLine &line)
      {
        header = line.words;
        for (const std::string &name : coordinate_names<dim>())
          {
            columns.coordinates.push_back(place_of(header, name));
            Require(columns.coordinates.back() >= 0,
                    line.where + "there is no column '" + name + "' in <" +
                      line.text + ">.");
          }
        columns.volume  = place_of(header, "volume");
        columns.mass    = place_of(header, "mass");
        columns.density = place_of(header, "density");
        Require(columns.volume >= 0 || columns.mass >= 0,
                line.where + "there is no column 'volume' in <" + line.text +
                  ">, and no column 'mass' to compute it from.");
        columns.reference    = find_group(line, vector("reference"));
        columns.displacement = find_group(line, vector("displacement"));
        auto &further        = result.names;
        if (has_mass())
          further.push_back("mass");
        for (const std::string &name : vector("reference"))
          if (has_reference())
            further.push_back(name);
        for (const auto &group : wanted)
          {
            const auto column_numbers = find_group(line, group);
            columns.further.insert(columns.further.end(),
                                   column_numbers.begin(),
                                   column_numbers.end());
            if (!column_numbers.empty())
              further.insert(further.end(), group.begin(), group.end());
          }
      }

      static std::vector<std::string>
      vector(const std::string &name)
      {
        std::vector<std::string> group;
        for (const std::string &axis : coordinate_names<dim>())
          group.push_back(name + "_" + axis);
        return group;
      }

      /// Return the columns of a group, or none of them.
      std::vector<int>
      find_group(const CsvLine                  &line,
                 const std::vector<std::string> &group) const
      {
        std::vector<int> column_numbers;
        std::string      there, missing;
        for (const std::string &name : group)
          {
            column_numbers.push_back(place_of(header, name));
            (column_numbers.back() < 0 ? missing : there) = name;
          }
        Require(there.empty() || missing.empty(),
                line.where + "there is a column '" + there + "', but no '" +
                  missing + "' in <" + line.text + ">.");
        return missing.empty() ? column_numbers : std::vector<int>();
      }

      bool
      has_mass() const
      {
        return columns.mass >= 0 || columns.density >= 0;
      }

      bool
      has_reference() const
      {
        return !columns.reference.empty() || !columns.displacement.empty();
      }

      double
      number(const CsvLine &row, const int column) const
      {
        return row.number(column, header[column]);
      }

      double
      positive(const CsvLine &row, const int column, const char *name) const
      {
        const double value = number(row, column);
        Require(value > 0.,
                row.where + "the " + name + " has to be positive in <" +
                  row.text + ">.");
        return value;
      }

      void
      read_point(const CsvLine &row)
      {
        PlacedPoint<dim> point;
        for (unsigned int d = 0; d < dim; ++d)
          point.x[d] = number(row, columns.coordinates[d]);
        const double mass = read_mass(row, point.volume);
        sum += point.volume;
        point.id = id++;

        Point<dim> reference = point.x;
        for (unsigned int d = 0; d < dim; ++d)
          if (!columns.reference.empty())
            reference[d] = number(row, columns.reference[d]);
          else if (!columns.displacement.empty())
            reference[d] -= number(row, columns.displacement[d]);
        const Point<dim> place = at_reference ? reference : point.x;
        check_position(row, place, std::min(point.x[0], reference[0]));
        point.cell = space.find(place);
        if (point.cell == numbers::invalid_unsigned_int)
          return;

        point.image = point.x;
        result.points.push_back(point);
        if (has_mass())
          result.values.push_back(mass);
        for (unsigned int d = 0; d < dim; ++d)
          if (has_reference())
            result.values.push_back(reference[d]);
        for (const int column : columns.further)
          result.values.push_back(number(row, column));
      }

      /// Return the mass of a point, and set its volume. Throw if mass, volume
      /// and density contradict each other.
      double
      read_mass(const CsvLine &row, double &volume) const
      {
        const double rho     = columns.density >= 0
                                 ? positive(row, columns.density, "density")
                                 : density;
        volume               = columns.volume >= 0
                                 ? positive(row, columns.volume, "volume")
                                 : positive(row, columns.mass, "mass") / rho;
        const double mass    = columns.mass >= 0
                                 ? positive(row, columns.mass, "mass")
                                 : rho * volume;
        const auto   is_near = [](const double a, const double b) {
          return std::abs(a - b) <= largest_difference * std::max(a, b);
        };
        Require(columns.density < 0 || columns.volume < 0 ||
                  is_near(mass, rho * volume),
                row.where +
                  "the columns 'mass', 'volume' and 'density' contradict each "
                  "other: " +
                  text_of(mass) + " kg are not " + text_of(rho) + " times " +
                  text_of(volume) + " in <" + row.text + ">.");
        const double ratio = mass / (volume * density);
        Require(ratio < largest_ratio && ratio > 1. / largest_ratio,
                row.where + "the density is " + text_of(mass / volume) +
                  " kg / m^3, but the material has " + text_of(density) +
                  ", in <" + row.text + ">. Are volume and mass in " +
                  volume_unit + " and kg?");
        Require(volume <= (1. + largest_excess) * grid_volume,
                row.where + "the volume of the point is " + text_of(volume) +
                  ' ' + volume_unit + ", but the grid has " +
                  text_of(grid_volume) + ", in <" + row.text + ">.");
        return mass;
      }

      void
      check_position(const CsvLine    &row,
                     const Point<dim> &place,
                     const double      smallest_x) const
      {
        Require(!is_axisymmetric || smallest_x > 0.,
                row.where +
                  "the point lies on the axis of symmetry, or beyond, in <" +
                  row.text + ">: its x has to be positive.");
        for (unsigned int d = 0; d < dim; ++d)
          Require(place[d] >= space.lower_corner()[d] &&
                    place[d] <= space.upper_corner()[d],
                  row.where + "the point (" + text_of(place) +
                    ") m lies outside of the grid.");
      }

      const double                                 density;
      const std::vector<std::vector<std::string>> &wanted;
      const bool              at_reference, is_axisymmetric;
      const SplineSpace<dim> &space;
      const std::string       volume_unit;

      Columns                  columns;
      std::vector<std::string> header;
      std::uint64_t            id  = 0;
      double                   sum = 0., grid_volume = 1.;
    };
  } // namespace



  template <int dim>
  int
  PointsOfFile<dim>::find(const std::string &name) const
  {
    return place_of(names, name);
  }



  template <int dim>
  PointsOfFile<dim>
  points_of_file(const std::string                           &file,
                 const std::string                           &section,
                 const double                                 density,
                 const std::vector<std::vector<std::string>> &wanted,
                 const bool                                   at_reference,
                 const bool                                   is_axisymmetric,
                 const SplineSpace<dim>                      &space)
  {
    PointsReader<dim> reader(
      density, wanted, at_reference, is_axisymmetric, space);
    read_points(file, section, [&](const CsvLine &row) { reader.read(row); });
    reader.check_sum("<" + file + "> of the parameter '" + section +
                     "/Points file'");
    std::vector<const PlacedPoint<dim> *> points;
    for (const PlacedPoint<dim> &point : reader.result.points)
      points.push_back(&point);
    check_places<dim>(points, file, section);
    return reader.result;
  }



  template <int dim>
  std::vector<std::string>
  find_in_points_file(const std::string &file,
                      const std::string &section,
                      const Point<dim>  &x)
  {
    std::vector<std::string> result;
    std::array<int, dim>     columns;
    read_points(file, section, [&](const CsvLine &row) {
      bool is_there = !row.is_header;
      for (unsigned int d = 0; d < dim; ++d)
        if (row.is_header)
          columns[d] = place_of(row.words, coordinate_names<dim>()[d]);
        else if (row.number(columns[d], coordinate_names<dim>()[d]) != x[d])
          is_there = false;
      if (is_there)
        result.push_back(row.where);
    });
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(PointsOfFile);
  GREVILLE_INSTANTIATE(points_of_file);
  GREVILLE_INSTANTIATE(find_in_points_file);
} // namespace greville

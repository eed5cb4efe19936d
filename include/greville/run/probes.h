// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/csv.h>
#include <greville/geometry/shape.h>
#include <greville/points/point_fields.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace greville
{
  /// Writes single points, and means over the points in shapes, to probes.csv:
  /// time, and for each probe its position, velocity, the Cauchy stress xx, yy,
  /// zz, xy, and the other fields in 'Output/Fields'. A mean is sum V q / sum V
  /// over the points that are in the shape at the time, with their initial
  /// volumes V, m^3. It is 0 without points.
  template <int dim>
  class Probes
  {
  public:
    /// Collective. Read positions and shapes from @p text ("x, y; SHAPE; ..."),
    /// take the nearest point of @p bodies for each position, and write the
    /// named output @p fields. Throws if an entry is neither a position nor a
    /// shape, if no point is within a cell's length of a position, or if a
    /// shape has no point.
    Probes(const std::string              &text,
           const std::vector<std::string> &fields,
           const BodyList<dim>            &bodies,
           const MPI_Comm                  comm);

    /// Collective. Begin the @p file; without probes it has only a header.
    void
    open(const std::string &file_name)
    {
      file.open(file_name, columns(), 12, comm);
    }

    /// Collective. Resume the file after its first @p n_bytes, and remove all
    /// later rows.
    bool
    resume(const std::string &file_name, const std::uint64_t n_bytes)
    {
      return file.resume(file_name, columns(), 12, n_bytes, comm);
    }

    /// Collective. Write all rows to disk, and return the bytes of the file.
    std::uint64_t
    sync()
    {
      return file.sync();
    }

    std::uint64_t
    n_bytes() const
    {
      return file.n_bytes();
    }

    bool
    empty() const
    {
      return probes.empty();
    }

    /// Fill the next row with the values of @p bodies, the first of which has
    /// number @p first, on this process. Velocities are multiplied by
    /// @p weight, and added if only @p velocities are taken.
    void
    take(const unsigned int   first,
         const BodyList<dim> &bodies,
         const double         weight     = 1.,
         const bool           velocities = false);

    /// Discard rows that were taken and will not be written.
    void
    forget()
    {
      sums.clear();
      weights = {};
    }

    /// Collective. Complete the row that has been taken, and return it.
    const std::vector<double> &
    finish(const double time);

    void
    write()
    {
      if (!probes.empty())
        file.write(row);
    }

    std::vector<std::string>
    columns() const;

  private:
    struct Probe
    {
      unsigned int              body;
      double                    id;
      std::optional<Shape<dim>> shape;
    };

    void
    add_point(const std::string &position, const BodyList<dim> &bodies);

    void
    add_shape(const std::string &shape, const BodyList<dim> &bodies);

    /// Return the number of values of a probe in the file. `sums` has more: the
    /// volume, and the velocity and volume of a second pass.
    unsigned int
    n_values() const
    {
      return 2 * dim + PointLayout<dim>::n_stress + n_more;
    }

    MPI_Comm                      comm;
    std::vector<Probe>            probes;
    std::vector<OutputField<dim>> fields;
    unsigned int                  n_more  = 0;  // numbers of the fields
    std::array<double, 2>         weights = {}; // of the passes
    std::vector<double>           sums, row;    // of the next row
    CsvWriter                     file;
  };
} // namespace greville

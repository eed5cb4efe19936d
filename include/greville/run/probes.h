// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_probes_h
#define greville_run_probes_h

#include <greville/base/csv.h>
#include <greville/geometry/shape.h>
#include <greville/points/point_fields.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace greville
{
  /**
   * Follows single points, and means over the points in shapes, in probes.csv:
   * time, and for each probe its position, velocity, the Cauchy stress xx, yy,
   * zz, xy, and what else 'Output/Fields' names. A mean is sum V q / sum V over
   * the points whose positions are in the shape at the time, with their initial
   * volumes V, m^3; where there are none, it is 0.
   */
  template <int dim>
  class Probes
  {
  public:
    /**
     * Collective. Take the points of @p bodies that are nearest to the
     * positions in @p text ("x, y; SHAPE; ..."), and its shapes, with the
     * output @p fields of those names. Throws where it is neither, and where no
     * point is nearer than a cell is long, or in a shape.
     */
    Probes(const std::string              &text,
           const std::vector<std::string> &fields,
           const BodyList<dim>            &bodies,
           const MPI_Comm                  comm);

    /**
     * Collective. Begin the @p file; where there are no probes it has only a
     * header.
     */
    void
    open(const std::string &file_name)
    {
      file.open(file_name, columns(), 12, comm);
    }

    /**
     * Collective. Go on with the first @p n_bytes of a file, and remove what an
     * earlier run has written behind them.
     */
    bool
    resume(const std::string &file_name, const std::uint64_t n_bytes)
    {
      return file.resume(file_name, columns(), 12, n_bytes, comm);
    }

    /**
     * Collective. Let all rows be on the disk. Returns the bytes of the file.
     */
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

    /**
     * The next row: what a list of bodies, the first of which is number @p
     * first, has on this process, with velocities times @p weight. It is added
     * where only the @p velocities are taken.
     */
    void
    take(const unsigned int   first,
         const BodyList<dim> &bodies,
         const double         weight     = 1.,
         const bool           velocities = false);

    /**
     * Discard rows that were taken and will not be written.
     */
    void
    forget()
    {
      sums.clear();
      weights = {};
    }

    /**
     * Collective. The row that has been taken, which is complete with this.
     */
    const std::vector<double> &
    finish(const double time);

    /**
     * Write the row that is complete.
     */
    void
    write();

    /**
     * Return the columns of the file.
     */
    std::vector<std::string>
    columns() const;

  private:
    struct Probe
    {
      unsigned int              body;
      double                    id;
      std::optional<Shape<dim>> shape;
    };

    /// The point that is nearest to a position.
    void
    add_point(const std::string &position, const BodyList<dim> &bodies);

    void
    add_shape(const std::string &shape, const BodyList<dim> &bodies);

    /// Numbers of a probe in the file; behind them, in sums, are the volume,
    /// and velocity and volume of a second pass.
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

#endif

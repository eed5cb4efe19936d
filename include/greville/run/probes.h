// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_probes_h
#define greville_run_probes_h

#include <greville/base/csv.h>
#include <greville/points/body_list.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * Follows single points in probes.csv: time, and for each probe its position,
   * velocity, and the Cauchy stress xx, yy, zz, xy.
   */
  template <int dim>
  class Probes
  {
  public:
    /**
     * Collective. Take the points of @p bodies that are nearest to the
     * positions in @p text ("x, y; x, y; ..."). Throws where it is none, and
     * where no point is nearer than a cell is long.
     */
    Probes(const std::string   &text,
           const BodyList<dim> &bodies,
           const MPI_Comm       comm);

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
    void
    go_on(const std::string &file_name, const std::uint64_t n_bytes)
    {
      file.go_on(file_name, columns(), 12, n_bytes, comm);
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
     * What has been taken is not to be written.
     */
    void
    forget()
    {
      values.clear();
    }

    /**
     * Collective. Write the row.
     */
    void
    write(const double time);

    /**
     * Those of the file.
     */
    std::vector<std::string>
    columns() const;

  private:
    struct Probe
    {
      unsigned int body;
      double       id;
    };

    MPI_Comm            comm;
    std::vector<Probe>  probes;
    std::vector<double> values; // of the next row
    CsvWriter           file;
  };
} // namespace greville

#endif

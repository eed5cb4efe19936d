// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_point_series_h
#define greville_run_point_series_h

#include <greville/points/point_fields.h>
#include <greville/run/vtkhdf_file.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * The points of a run at all of its times in one file, points.vtkhdf, see
   * VtkHdfFile: positions, m, and fields, vectors in three columns and other
   * components in a data set each. A field that is not written at some time is
   * NaN there. Beside it lies points.xdmf, which says the same to readers that
   * do not know times in VTKHDF, such as ParaView 5.11.
   *
   * The file is closed between two times, so that it can be read while the run
   * goes on. While a time is appended, its journal points.vtkhdf.changing lies
   * beside it, with all that describes the data: a run that goes on makes of a
   * file with it what it was, since HDF5 may crash on half of a change.
   */
  template <int dim>
  class PointSeries
  {
  public:
    static constexpr const char *file_name = "points.vtkhdf";

    explicit PointSeries(const std::string &directory);

    /**
     * Collective. Append a time; the first one begins a new file. Throws
     * dealii::ExcMessage on all processes where the file cannot be written.
     */
    void
    write(const double                         time,
          const BodyList<dim>                 &bodies,
          const std::vector<OutputField<dim>> &fields,
          const MPI_Comm                       comm);

    /**
     * Collective. Go on behind the first @p n_times that an earlier run has
     * written, and remove what comes behind them. Throws dealii::ExcMessage on
     * all processes where the file does not have them, or cannot be read: the
     * next time begins a new file then.
     */
    void
    go_on(const unsigned int n_times, const MPI_Comm comm);

  private:
    /**
     * Collective. What is between these two can be taken back.
     */
    void
    begin_change(const MPI_Comm comm);

    void
    end_change(const MPI_Comm comm);

    void
    append(const BodyList<dim>                 &bodies,
           const std::vector<OutputField<dim>> &fields,
           const bool                           is_new_part,
           const MPI_Comm                       comm);

    void
    write_xdmf(const MPI_Comm comm);

    const std::string directory, path, journal;

    VtkHdfContent content;

    // Of the file when it was closed.
    ChunkPlaces chunks;

    // Of points.xdmf, without its begin and its end; the first process has it.
    std::string  xdmf;
    unsigned int n_times_of_xdmf = 0, n_fields_of_xdmf = 0;
  };
} // namespace greville

#endif

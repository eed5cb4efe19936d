// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_vtkhdf_file_h
#define greville_run_vtkhdf_file_h

#include <greville/base/disk.h>
#include <greville/base/hdf5_calls.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace greville
{
  /**
   * Points at a time, as VtkHdfFile stores them.
   */
  struct VtkHdfTime
  {
    double time;
    /// The row of the first point.
    std::uint64_t first_point, n_points;
    /// The place of the number of points in VtkHdfFile::n_points_of_parts.
    std::uint64_t part;
  };



  /**
   * What a file has.
   */
  struct VtkHdfContent
  {
    std::vector<VtkHdfTime> times;
    /// Different numbers of points: times with the same share their cells.
    std::vector<std::uint64_t> parts;
    /// Fields with their numbers of columns.
    std::map<std::string, unsigned int> fields;

    std::uint64_t
    n_points() const
    {
      return times.empty() ? 0
                           : times.back().first_point + times.back().n_points;
    }

    /**
     * Of the parts before this one.
     */
    std::uint64_t
    n_cells_before(const std::uint64_t part) const;
  };



  /**
   * Where a file has the numbers of its data sets, in chunks that never move,
   * and how many of them are known of each data set.
   */
  struct ChunkPlaces
  {
    std::vector<ByteRange>               ranges;
    std::map<std::string, std::uint64_t> n_known;
  };



  /**
   * An open file of HDF5 with points that change in time: an unstructured grid
   * of vertices by version 2.0 of the format VTKHDF
   * (https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format). All
   * processes write it together: constructor and functions are collective, and
   * throw dealii::ExcMessage with what HDF5 says.
   *
   * Numbers are floats, but for the field id, whose numbers are doubles: floats
   * have 24 bits, which do not number the points of a large run.
   */
  class VtkHdfFile
  {
  public:
    /// Where data sets are: /VTKHDF/, and below it fields and times.
    static const std::string root, point_data, steps;

    VtkHdfFile(const std::string &path, const bool is_new, const MPI_Comm comm);

    static bool
    is_double(const std::string &field);

    /**
     * Make what the format demands, without a time. @p rows_of_chunk points are
     * stored together.
     */
    void
    make_structure(const std::uint64_t rows_of_chunk);

    void
    make_field(const std::string  &name,
               const unsigned int  n_columns,
               const std::uint64_t rows_of_chunk);

    /**
     * Give all data sets the number of rows that this content has.
     */
    void
    set_rows(const VtkHdfContent &content);

    /**
     * Write rows of this process: its first one is number @p first of all.
     */
    template <typename T>
    void
    write(const std::string    &name,
          const std::uint64_t   first,
          const std::vector<T> &values,
          const unsigned int    n_columns = 0);

    /**
     * Write the cells of the last part, whose points from @p first on are
     * @p own of this process.
     */
    void
    write_cells(const VtkHdfContent &content,
                const std::uint64_t  first,
                const std::uint64_t  own);

    /**
     * Write what describes the last time and its part.
     */
    void
    write_time(const VtkHdfContent &content, const bool is_new_part);

    /**
     * NaN, for a field at @p n_rows points that do not have it.
     */
    void
    write_nothing(const std::string  &field,
                  const unsigned int  n_columns,
                  const std::uint64_t first,
                  const std::uint64_t n_rows);

    /**
     * The number of times that readers see.
     */
    void
    set_n_times(const std::uint64_t n);

    /**
     * The first @p n_times, with all fields. Throws where there are fewer.
     */
    VtkHdfContent
    read(const unsigned int n_times) const;

    /**
     * Add the places of chunks that are not known yet.
     */
    void
    find_chunks(const VtkHdfContent &content, ChunkPlaces &places) const;

    /**
     * Close the file.
     */
    void
    finish();

  private:
    void
    make(const std::string  &name,
         const hid_t         type,
         const unsigned int  n_columns,
         const std::uint64_t rows_of_chunk);

    void
    set_rows_of(const std::string &name, const std::uint64_t n_rows);

    template <typename T>
    std::vector<T>
    read_all(const std::string &name) const;

    std::map<std::string, unsigned int>
    read_fields() const;

    const MPI_Comm   comm;
    const HDF5Handle access;
    HDF5Handle       file;
  };
} // namespace greville

#endif

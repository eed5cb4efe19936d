// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace greville
{
  /// A line of a table whose columns are separated by commas. The first line
  /// contains the names of the columns.
  struct CsvLine
  {
    bool                     is_header;
    std::string              text;
    std::vector<std::string> words; // without spaces around them
    std::string where; // file, parameter and line, for messages: "...: "

    /// Return the number in a column. Throws dealii::ExcMessage with the
    /// @p name of the column if there is none or it is not finite.
    double
    number(const unsigned int column, const std::string &name) const;
  };



  /// Call @p visit with each line of @p file that is neither empty nor a
  /// comment (#), keeping only one line in memory. Throws dealii::ExcMessage if
  /// the file cannot be read or contains only a header; messages name the
  /// @p parameter that gives the file.
  void
  read_csv(const std::string                          &file,
           const std::string                          &parameter,
           const std::function<void(const CsvLine &)> &visit);



  /// A writer of a table whose columns are separated by commas, on the first
  /// process. All functions are collective, and throw dealii::ExcMessage if the
  /// file cannot be written.
  class CsvWriter
  {
  public:
    /// Begin with the @p names of the columns. Numbers get @p precision digits.
    void
    open(const std::string              &file,
         const std::vector<std::string> &names,
         const unsigned int              precision,
         const MPI_Comm                  comm);

    /// Continue a file of open() after its first @p n_bytes and remove the
    /// rest. Throws if the file is shorter or has other columns. If the file
    /// does not exist, a new one is opened and false is returned.
    bool
    resume(const std::string              &file,
           const std::vector<std::string> &names,
           const unsigned int              precision,
           const std::uint64_t             n_bytes,
           const MPI_Comm                  comm);

    /// Write a line, which is in the file even if the process ends abnormally.
    /// Throws if the file has been removed or replaced.
    void
    write(const std::vector<double> &values);

    /// Write the file to the disk. Returns its number of bytes, or 0 if it has
    /// not been opened.
    std::uint64_t
    sync();

    /// Return the number of bytes on the first process; 0 on others.
    std::uint64_t
    n_bytes() const
    {
      return size;
    }

  private:
    template <typename T>
    void
    write_line(const std::vector<T> &words);

    std::string   file;
    std::ofstream out;
    std::uint64_t size  = 0;
    std::uint64_t inode = 0; // 0: not yet known
    MPI_Comm      comm  = MPI_COMM_NULL;
  };
} // namespace greville

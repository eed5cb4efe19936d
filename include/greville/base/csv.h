// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_csv_h
#define greville_base_csv_h

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace greville
{
  /**
   * A line of a table whose columns are separated by commas. The first one has
   * the names of the columns.
   */
  struct CsvLine
  {
    bool                     is_header;
    std::string              text;
    std::vector<std::string> words; // without spaces around them
    std::string where; // file, parameter and line, for messages: "...: "

    /**
     * The number in a column. Throws dealii::ExcMessage, which names the
     * column by @p name, where there is none or it is not finite.
     */
    double
    number(const unsigned int column, const std::string &name) const;
  };



  /**
   * Call @p visit with each line of @p file that is neither empty nor a comment
   * (#), one after the other, so that no more than a line is in memory. Throws
   * dealii::ExcMessage where the file cannot be read or has no line but a
   * header; messages name the @p parameter that gives the file.
   */
  void
  read_csv(const std::string                          &file,
           const std::string                          &parameter,
           const std::function<void(const CsvLine &)> &visit);



  /**
   * Writes a table whose columns are separated by commas, from the first
   * process. All functions are collective, and throw dealii::ExcMessage where
   * the file cannot be written.
   */
  class CsvWriter
  {
  public:
    /**
     * Begin with the @p names of the columns. Numbers get @p precision digits.
     */
    void
    open(const std::string              &file,
         const std::vector<std::string> &names,
         const unsigned int              precision,
         const MPI_Comm                  comm);

    /**
     * Go on with a file of open() after its first @p n_bytes: what comes
     * behind them is removed. Throws where the file is shorter or has other
     * columns. Where it is not there a new one is opened, and the result is
     * false.
     */
    bool
    go_on(const std::string              &file,
          const std::vector<std::string> &names,
          const unsigned int              precision,
          const std::uint64_t             n_bytes,
          const MPI_Comm                  comm);

    /**
     * Write a line. It is in the file when the process ends, however it does.
     * A file that has been removed or replaced is an error.
     */
    void
    write(const std::vector<double> &values);

    /**
     * Write the file to the disk. Returns its number of bytes, 0 where it has
     * not been opened.
     */
    std::uint64_t
    sync();

    /**
     * The number of bytes, on the first process; 0 on others.
     */
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

#endif

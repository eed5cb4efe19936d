// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <map>
#include <string>
#include <vector>

namespace greville
{
  /// Rows of numbers distributed over the processes: all rows of the first
  /// process come before the rows of the second.
  struct DistributedTable
  {
    std::string              name;
    std::vector<std::string> columns;
    /// The rows of this process, one after another.
    std::vector<double> values;

    std::size_t
    n_rows() const
    {
      return columns.empty() ? 0 : values.size() / columns.size();
    }

    /// Collective. Return the values of all rows on all processes, for small
    /// tables.
    std::vector<double>
    gather(const MPI_Comm comm) const;
  };



  /// The content of a file: texts and tables, both by name.
  struct TablesFile
  {
    std::map<std::string, std::string> texts;
    std::vector<DistributedTable>      tables;

    /// Return the table with a name. Throws dealii::ExcMessage if there is
    /// none.
    const DistributedTable &
    table(const std::string &name) const;

    /// Return the text with a name. Throws dealii::ExcMessage if there is none.
    const std::string &
    text(const std::string &name) const;
  };



  /**
   * Collective. Write @p content to a file of HDF5: texts are attributes of the
   * file, a table is a data set of doubles with its columns as an attribute.
   * Each of them has a checksum, which does not depend on the number of
   * processes.
   *
   * The file appears under its name when it is complete and on the disk: it is
   * written to FILE.new, which then replaces the file. Throws
   * dealii::ExcMessage on all processes if this fails.
   */
  void
  write_tables(const std::string &file,
               const TablesFile  &content,
               const MPI_Comm     comm);



  /// Collective. Read a file of write_tables() on any number of processes.
  /// Their numbers of rows of a table differ by at most one. Throws
  /// dealii::ExcMessage on all processes if the file cannot be read, is
  /// truncated, or its checksums do not match.
  TablesFile
  read_tables(const std::string &file, const MPI_Comm comm);
} // namespace greville

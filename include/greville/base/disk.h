// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace greville
{
  /// Make an empty file on a disk with room for @p size bytes. Throws
  /// dealii::ExcMessage with the system's message if there is not enough room.
  /// A library that detects a full disk would try to write its remaining data
  /// at the end of the program.
  void
  make_file(const std::string &file, const std::uint64_t size);

  /// Return the system's reason why a file cannot be extended, "No space left
  /// on device. ", or an empty text. Since the error that a library met is no
  /// longer available, writing at the end of the file is tried again.
  std::string
  system_reason(const std::string &file);

  /// Make the system write a file or a folder to the disk. Throws
  /// dealii::ExcMessage if this fails.
  void
  write_to_disk(const std::string &file);



  /// Collective. Write the texts of all processes to a file, in the order of
  /// the processes, which write at the same time. Throws dealii::ExcMessage on
  /// all processes if the file cannot be written.
  void
  write_together(const std::string              &file,
                 const std::vector<std::string> &own,
                 const MPI_Comm                  comm);

  /// Collective. Return the range of @p n items for this process: the first
  /// item and the end. The numbers of items differ by at most one.
  std::pair<std::uint64_t, std::uint64_t>
  share_of(const std::uint64_t n, const MPI_Comm comm);

  /// Return a checksum of numbers at the positions from @p first on. The
  /// checksums of all processes add up to the checksum of all numbers.
  std::uint64_t
  checksum(const std::vector<double> &values, const std::uint64_t first);

  /// Return the checksum of several texts: of the last @p text, with the
  /// checksum @p before of the previous ones.
  std::uint64_t
  checksum(const std::string &text, const std::uint64_t before);



  /// Collective. Append to a complete @p file the checksum of all of its bytes,
  /// as a line of 64 letters that HDF5 ignores. Each process reads its share of
  /// the file, piece by piece. Throws dealii::ExcMessage if this fails.
  void
  seal_file(const std::string &file, const MPI_Comm comm);

  /// Collective. Throw dealii::ExcMessage if @p file cannot be read or does not
  /// end with the checksum of its preceding bytes, that is, if any byte has
  /// been changed or is missing. Reads as seal_file().
  void
  check_seal(const std::string &file, const MPI_Comm comm);
} // namespace greville

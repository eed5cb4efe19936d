// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_disk_h
#define greville_base_disk_h

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace greville
{
  /**
   * Make an empty file on a disk with room for @p size bytes. Throws
   * dealii::ExcMessage where there is no room: a full disk is found here, where
   * the system says so, and not by a library, which would try to write what is
   * left when the program ends.
   */
  void
  make_file(const std::string &file, const std::uint64_t size);

  /**
   * Have room on the disk for @p size bytes behind the end of a file, whose
   * length stays. Throws dealii::ExcMessage where there is none.
   */
  void
  reserve_room(const std::string &file, const std::uint64_t size);

  /**
   * The system's reason why a file cannot be written on, "No space left on
   * device. ", or nothing. What a library met is no longer known: it is tried
   * again at the end of the file.
   */
  std::string
  system_reason(const std::string &file);

  /**
   * Have the system write a file, or a folder, to the disk. Throws
   * dealii::ExcMessage where that fails.
   */
  void
  write_to_disk(const std::string &file);



  /**
   * The bytes of a file from @p begin on, up to @p end.
   */
  struct ByteRange
  {
    std::uint64_t begin, end;
  };

  /**
   * Write a journal: the length of a file and its bytes but those of @p kept,
   * which need no order and may overlap. The journal appears complete, or not
   * at all. Throws dealii::ExcMessage where it cannot be written.
   */
  void
  write_journal(const std::string            &journal,
                const std::string            &file,
                const std::vector<ByteRange> &kept);

  /**
   * Make a file what it was when its journal was written, if the bytes that the
   * journal lacks are as they were. Throws dealii::ExcMessage, and changes
   * nothing, where the journal is damaged.
   */
  void
  take_back(const std::string &journal, const std::string &file);



  /**
   * Collective. The first of @p n things that this process takes, and the one
   * behind its last: each takes the same number, but for one.
   */
  std::pair<std::uint64_t, std::uint64_t>
  share_of(const std::uint64_t n, const MPI_Comm comm);

  /**
   * A sum over numbers with their places, of which the first is @p first, so
   * that every process can add up its own. It changes with each bit.
   */
  std::uint64_t
  checksum(const std::vector<double> &values, const std::uint64_t first);

  /**
   * The same of one text behind others, whose checksum is @p before.
   */
  std::uint64_t
  checksum(const std::string &text, const std::uint64_t before);



  /**
   * Collective. Append to a complete @p file the checksum of all of its bytes,
   * as a line of 64 letters that HDF5 does not read. Each process reads its
   * share of the file, piece by piece. Throws dealii::ExcMessage where that
   * fails.
   */
  void
  seal_file(const std::string &file, const MPI_Comm comm);

  /**
   * Collective. Throw dealii::ExcMessage where @p file cannot be read, or does
   * not end with the checksum of what stands before it: where any of its bytes
   * has been changed or is missing. Reads as seal_file().
   */
  void
  check_seal(const std::string &file, const MPI_Comm comm);
} // namespace greville

#endif

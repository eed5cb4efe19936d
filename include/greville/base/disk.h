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
   * dealii::ExcMessage if there is not enough room: a full disk is then
   * detected here, with the system's message, and not in a library, which would
   * try to write its remaining data at the end of the program.
   */
  void
  make_file(const std::string &file, const std::uint64_t size);

  /**
   * Reserve room on the disk for @p size bytes after the end of a file, without
   * changing its length. Throws dealii::ExcMessage if there is none.
   */
  void
  reserve_room(const std::string &file, const std::uint64_t size);

  /**
   * Return the system's reason why a file cannot be extended, "No space left on
   * device. ", or an empty text. Since the error that a library met is no
   * longer available, writing at the end of the file is tried again.
   */
  std::string
  system_reason(const std::string &file);

  /**
   * Make the system write a file or a folder to the disk. Throws
   * dealii::ExcMessage if this fails.
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
   * Write a journal: the length of a file and all of its bytes except those in
   * @p kept, which may be unsorted and overlap. The journal appears complete or
   * not at all. Throws dealii::ExcMessage if it cannot be written.
   */
  void
  write_journal(const std::string            &journal,
                const std::string            &file,
                const std::vector<ByteRange> &kept);

  /**
   * Restore a file from its journal, provided that the bytes that the journal
   * omits have not changed. Throws dealii::ExcMessage, and changes nothing, if
   * the journal is damaged.
   */
  void
  take_back(const std::string &journal, const std::string &file);



  /**
   * Collective. Return the range of @p n items for this process: the first item
   * and the end. The numbers of items differ by at most one.
   */
  std::pair<std::uint64_t, std::uint64_t>
  share_of(const std::uint64_t n, const MPI_Comm comm);

  /**
   * Return a sum over numbers and their positions, which begin with @p first,
   * so that each process can add up its own. It changes with each bit.
   */
  std::uint64_t
  checksum(const std::vector<double> &values, const std::uint64_t first);

  /// Return the checksum of one text after others, whose checksum is @p before.
  std::uint64_t
  checksum(const std::string &text, const std::uint64_t before);



  /**
   * Collective. Append to a complete @p file the checksum of all of its bytes,
   * as a line of 64 letters that HDF5 ignores. Each process reads its share of
   * the file, piece by piece. Throws dealii::ExcMessage if this fails.
   */
  void
  seal_file(const std::string &file, const MPI_Comm comm);

  /**
   * Collective. Throw dealii::ExcMessage if @p file cannot be read or does not
   * end with the checksum of its preceding bytes, that is, if any byte has been
   * changed or is missing. Reads as seal_file().
   */
  void
  check_seal(const std::string &file, const MPI_Comm comm);
} // namespace greville

#endif

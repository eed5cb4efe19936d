// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_disk_h
#define greville_base_disk_h

#include <cstdint>
#include <string>

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
} // namespace greville

#endif

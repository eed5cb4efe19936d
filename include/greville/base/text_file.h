// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <fstream>
#include <string>

namespace greville
{
  /// Open a text file. The stream has failed if the file cannot be read. Throws
  /// dealii::ExcMessage, which begins with @p what, for a folder, and for a
  /// device, whose lines may have no end.
  std::ifstream
  open_text_file(const std::string &file, const std::string &what);

  /// Read the next line of a text, and count it in @p number, which is 0 before
  /// the first line. The byte order mark of UTF-8, with which some editors
  /// begin a file, is skipped. Returns whether there is a line.
  bool
  read_text_line(std::istream &stream, std::string &line, unsigned int &number);

  /// Throw dealii::ExcMessage, which begins with @p place, if @p text is not
  /// UTF-8.
  void
  check_utf8(const std::string &text, const std::string &place);
} // namespace greville

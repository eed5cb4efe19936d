// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_csv_h
#define greville_base_csv_h

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
} // namespace greville

#endif

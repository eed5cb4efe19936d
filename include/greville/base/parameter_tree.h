// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_parameter_tree_h
#define greville_base_parameter_tree_h

#include <greville/base/parameters.h>

#include <istream>
#include <ostream>
#include <string>
#include <vector>

namespace greville
{
  /**
   * Whether a parameter file is one of JSON or XML, by the end of its name.
   */
  bool
  is_parameter_tree(const std::string &file);

  /**
   * The lines that a file of JSON or XML stands for. JSON has sections within
   * sections with the names of a .prm file, or slashes in a name; a list is a
   * value with commas, and a list of lists has semicolons between the inner
   * ones. XML, and JSON with a "default_value" in its parameters, are those
   * that dealii::ParameterHandler writes. Throws dealii::ExcMessage, which
   * begins with the place, where the file has another form.
   */
  std::vector<ParameterLine>
  parameter_lines_of_tree(std::istream &stream, const std::string &file);

  /**
   * Write the text of a .prm file as JSON: its sections, names and values.
   */
  void
  write_as_json(std::ostream &out, const std::string &text);

  /**
   * Write the text of a .prm file as XML with all that dealii::ParameterHandler
   * writes of its parameters, which @p reference knows. That has sections for
   * all names and models, as print_parameter_reference() shows them.
   */
  void
  write_as_xml(std::ostream                   &out,
               const std::string              &text,
               const dealii::ParameterHandler &reference);
} // namespace greville

#endif

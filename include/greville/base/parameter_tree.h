// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/parameters.h>

#include <boost/property_tree/ptree_fwd.hpp>
#include <functional>
#include <istream>
#include <ostream>
#include <string>
#include <vector>

namespace greville
{
  /// Return whether a parameter file is in JSON or XML, judging by the
  /// extension.
  bool
  is_parameter_tree(const std::string &file);

  /// Return the tree of @p prm, whose names are not mangled.
  boost::property_tree::ptree
  tree_of(const dealii::ParameterHandler &prm);

  /// Call @p visit with the path, the name and the tree of each parameter.
  void
  for_each_parameter(
    const dealii::ParameterHandler                                 &prm,
    const std::function<void(const std::vector<std::string> &,
                             const std::string &,
                             const boost::property_tree::ptree &)> &visit);

  /// Return the parameter lines of a JSON or XML file. JSON contains nested
  /// sections with the names of a .prm file, or names with slashes; a list
  /// becomes a value with commas, and a list of lists has semicolons between
  /// the inner lists. XML files, and JSON files with a "default_value" in their
  /// parameters, have the format written by dealii::ParameterHandler. Throws
  /// dealii::ExcMessage, which begins with the place, if the file has another
  /// form.
  std::vector<ParameterLine>
  parameter_lines_of_tree(std::istream &stream, const std::string &file);

  /// Write the text of a .prm file as JSON: its sections, names and values.
  void
  write_as_json(std::ostream &out, const std::string &text);
} // namespace greville

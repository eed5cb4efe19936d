// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <string>
#include <vector>

namespace greville
{
  /// Return the address of the first of the functions @p names that the shared
  /// library @p file contains. A library stays loaded. Throws
  /// dealii::ExcMessage with the @p parameter and the file if the library
  /// cannot be loaded or contains none of the functions.
  void *
  function_of_library(const std::string              &file,
                      const std::vector<std::string> &names,
                      const std::string              &parameter);

  /// Load a plugin and call its function (plugin.h), which adds laws, loads,
  /// integrators and other parts (add_material(), ...). A plugin that is
  /// already loaded is not called again. Throws like function_of_library(),
  /// also if the plugin was compiled for another build, and the exceptions of
  /// the plugin's function.
  void
  load_plugin(const std::string &file, const std::string &parameter);
} // namespace greville

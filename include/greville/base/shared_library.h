// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <string>
#include <vector>

namespace greville
{
  /// Return the address of the first of the functions @p names that the shared
  /// library @p file contains. A library stays loaded. Throws
  /// dealii::ExcMessage with the @p parameter and the file if it cannot be
  /// loaded or contains none of them.
  void *
  function_of_library(const std::string              &file,
                      const std::vector<std::string> &names,
                      const std::string              &parameter);

  /// Load a plugin and call its function (plugin.h), which adds laws, loads,
  /// integrators and other parts (add_material(), ...). A plugin that is
  /// already loaded is not called again. Throws as function_of_library(), if
  /// the plugin was compiled for another build, and the exceptions of the
  /// function.
  void
  load_plugin(const std::string &file, const std::string &parameter);
} // namespace greville

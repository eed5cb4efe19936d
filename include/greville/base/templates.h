// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/program.h>

#include <string>
#include <vector>

/// Parameter files that are part of the program.
namespace greville
{
  /// Return the templates: prm/templates, and the examples of the guide in
  /// doc/user/examples.
  std::vector<ProgramTemplate>
  simulation_templates();

  /// Return the sections that the references of the programs show as examples:
  /// the files of prm/simulation/sections and prm/mass/sections, one after
  /// another.
  std::string
  simulation_examples();

  std::string
  benchmark_examples();
} // namespace greville

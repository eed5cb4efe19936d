// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_templates_h
#define greville_base_templates_h

#include <greville/base/program.h>

#include <string>
#include <vector>

/**
 * Parameter files that are compiled in.
 */
namespace greville
{
  /**
   * Those to begin with: prm/templates, and those of the guide in
   * doc/user/examples.
   */
  std::vector<ProgramTemplate>
  simulation_templates();

  /**
   * The sections that the references of the programs show as examples: the
   * files of prm/simulation/sections and of prm/mass/sections, one behind the
   * other.
   */
  std::string
  simulation_examples();

  std::string
  benchmark_examples();
} // namespace greville

#endif

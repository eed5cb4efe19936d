// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_templates_h
#define greville_simulation_templates_h

#include <greville/base/program.h>

#include <vector>

namespace greville
{
  /**
   * The parameter files of prm/templates and of the guide (doc/user/examples),
   * which are compiled in.
   */
  std::vector<ProgramTemplate>
  simulation_templates();
} // namespace greville

#endif

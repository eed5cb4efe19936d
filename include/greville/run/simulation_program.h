// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_run_simulation_program_h
#define greville_run_simulation_program_h

#include <greville/base/program.h>

namespace greville
{
  /// The program greville, which runs and checks simulations.
  Program
  simulation_program();
} // namespace greville

#endif

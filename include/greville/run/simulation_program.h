// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/program.h>

namespace greville
{
  /// The program greville, which runs and checks simulations.
  Program
  simulation_program();
} // namespace greville

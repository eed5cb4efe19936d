// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/program.h>

namespace greville
{
  /// The program greville_benchmark, which solves linear systems.
  Program
  benchmark_program();
} // namespace greville

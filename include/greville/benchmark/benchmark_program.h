// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_benchmark_benchmark_program_h
#define greville_benchmark_benchmark_program_h

#include <greville/base/program.h>

namespace greville
{
  /// The program greville_benchmark, which solves linear systems.
  Program
  benchmark_program();
} // namespace greville

#endif

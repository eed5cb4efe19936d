// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

// For executables. deal.II ends a program before main() if DEAL_II_NUM_THREADS
// is not a positive number. Greville has one thread per process in any case, so
// the variable is removed before shared libraries are initialized, when the C++
// library cannot be used yet.

namespace
{
  void
  forget_threads(int, char **, char **environment)
  {
    const char *const name = "DEAL_II_NUM_THREADS=";
    char            **kept = environment;
    for (; *environment; ++environment)
      {
        unsigned int k = 0;
        while (name[k] && (*environment)[k] == name[k])
          ++k;
        if (name[k])
          *kept++ = *environment;
      }
    *kept = nullptr;
  }

  __attribute__((section(".preinit_array"),
                 used)) void (*const before_libraries)(int, char **, char **) =
    forget_threads;
} // namespace

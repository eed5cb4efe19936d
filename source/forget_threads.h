// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_forget_threads_h
#define greville_forget_threads_h

// For executables. deal.II ends a program before main() if DEAL_II_NUM_THREADS
// is no positive number; a process of Greville has one thread whatever it is.
// So it is taken away before shared libraries begin, where nothing of the
// library of C++ can be called.

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

#endif

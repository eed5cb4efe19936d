// SPDX-License-Identifier: LGPL-2.1-or-later

// A library that is loaded before Open MPI. A process that waits for a message
// calls sched_yield() continually and keeps a core busy that another test
// needs. With this library, it sleeps for a moment after a thousand calls in a
// row, about a millisecond.

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

extern "C" int
sched_yield() noexcept
{
  constexpr long               row = 20000, pause = 20000; // ns
  static thread_local timespec last  = {0, 0};
  static thread_local unsigned n_row = 0;

  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  const bool is_in_row =
    now.tv_sec == last.tv_sec && now.tv_nsec - last.tv_nsec < row;
  n_row = is_in_row ? n_row + 1 : 0;
  last  = now;
  if (n_row < 1000)
    return syscall(SYS_sched_yield);
  const timespec moment = {0, pause};
  nanosleep(&moment, nullptr);
  clock_gettime(CLOCK_MONOTONIC, &last);
  return 0;
}

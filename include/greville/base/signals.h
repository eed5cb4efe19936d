// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_signals_h
#define greville_base_signals_h

#include <deal.II/base/mpi.h>

#include <string>

namespace greville
{
  /**
   * Catches the signals by which users and batch systems ask a run to end
   * (SIGINT, SIGTERM, SIGHUP) or to write a checkpoint (SIGUSR1), as long as
   * the object lives; there is one at a time. A second signal to end has its
   * usual effect: the process ends at once.
   */
  class SignalCatcher
  {
  public:
    SignalCatcher();

    SignalCatcher(const SignalCatcher &) = delete;
    SignalCatcher &
    operator=(const SignalCatcher &) = delete;

    ~SignalCatcher();

    /**
     * Collective. The number of a signal that any process has got since the
     * last call, 0 if none; one to end before SIGUSR1. All processes get the
     * same answer.
     */
    static int
    take(const MPI_Comm comm);

    /**
     * "SIGTERM".
     */
    static std::string
    name(const int signal);
  };
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <string>

namespace greville
{
  /// A handler, during its lifetime, of the signals by which users and batch
  /// systems ask a run to end (SIGINT, SIGTERM, SIGHUP) or to write a
  /// checkpoint (SIGUSR1); only one exists at a time. A second signal to end
  /// has its usual effect: the process ends at once.
  class SignalCatcher
  {
  public:
    SignalCatcher();

    SignalCatcher(const SignalCatcher &) = delete;
    SignalCatcher &
    operator=(const SignalCatcher &) = delete;

    ~SignalCatcher();

    /// Collective. Return the number of a signal that any process has received
    /// since the last call, 0 if none. Signals to end take precedence over
    /// SIGUSR1. All processes return the same number.
    static int
    take(const MPI_Comm comm);

    /// Return the name of a signal, such as "SIGTERM".
    static std::string
    name(const int signal);
  };
} // namespace greville

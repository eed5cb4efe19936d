// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/signals.h>

#include <array>
#include <csignal>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Signals that end a run come after SIGUSR1, so that the largest position
    // has precedence.
    constexpr std::array<int, 4> signals = {{SIGUSR1, SIGHUP, SIGINT, SIGTERM}};

    std::array<struct sigaction, 4> before;

    // The position of the received signal, plus 1.
    volatile std::sig_atomic_t last = 0;
  } // namespace
} // namespace greville

extern "C"
{
  static void
  greville_catch_signal(const int signal)
  {
    for (int k = 0; k < int(greville::signals.size()); ++k)
      if (greville::signals[k] == signal)
        {
          if (k + 1 > greville::last)
            greville::last = k + 1;
          if (k > 0)
            std::signal(signal, SIG_DFL);
        }
  }
}

namespace greville
{
  SignalCatcher::SignalCatcher()
  {
    last                    = 0;
    struct sigaction action = {};
    action.sa_handler       = greville_catch_signal;
    sigemptyset(&action.sa_mask);
    // MPI's system calls are restarted.
    action.sa_flags = SA_RESTART;
    for (unsigned int k = 0; k < signals.size(); ++k)
      sigaction(signals[k], &action, &before[k]);
  }



  SignalCatcher::~SignalCatcher()
  {
    for (unsigned int k = 0; k < signals.size(); ++k)
      sigaction(signals[k], &before[k], nullptr);
  }



  int
  SignalCatcher::take(const MPI_Comm comm)
  {
    const int own   = last;
    const int place = Utilities::MPI::max(own, comm);
    // A signal that arrives in between is found by the next call.
    if (last == own)
      last = 0;
    return place == 0 ? 0 : signals[place - 1];
  }



  std::string
  SignalCatcher::name(const int signal)
  {
    return signal == SIGUSR1  ? "SIGUSR1"
           : signal == SIGHUP ? "SIGHUP"
           : signal == SIGINT ? "SIGINT"
                              : "SIGTERM";
  }
} // namespace greville

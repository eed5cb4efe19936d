// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>
#include <greville/materials/umat_call.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <unistd.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    const UmatCall *volatile call_under_way = nullptr;

    std::uint64_t n_calls = 0;

    unsigned int this_process = 0;

    struct Fault
    {
      int         signal;
      const char *text;
    };

    constexpr std::array<Fault, 5> fault_signals = {
      {{SIGSEGV, "has used memory that it does not have (SIGSEGV)"},
       {SIGBUS, "has used memory that it does not have (SIGBUS)"},
       {SIGFPE,
        "has divided by zero or has another invalid operation (SIGFPE)"},
       {SIGILL, "has an instruction that this processor lacks (SIGILL)"},
       {SIGABRT, "has aborted (SIGABRT)"}}};

    std::array<struct sigaction, fault_signals.size()> earlier_actions;

    // The stack of a law may be what is exhausted.
    char stack_of_signals[1 << 16];

    // Of the clock that looks for calls without an end: the time between two
    // looks, s, and how often the last one has found the same call.
    constexpr int clock_signal = SIGVTALRM;
    timer_t       clock_of_calls;
    double        clock_period = 0.;
    unsigned int  n_looks      = 0;
    std::uint64_t seen_call    = 0;



    /**
     * End the process. Where several processes have the same fault, the first
     * one reports it, and MPI ends the others while they wait.
     */
    [[noreturn]] void
    end_process(const char *what)
    {
      char      text[4096];
      const int n = std::snprintf(
        text, sizeof(text) / 2, "%s: ", program_invocation_short_name);
      call_under_way->write_message(text + n, sizeof(text) - n - 2, what);
      std::strcat(text, ".\n");
      if (this_process > 0)
        {
          std::signal(SIGTERM, SIG_DFL);
          // mpirun takes up to a second or two on a busy machine.
          struct timespec wait = {1 + std::min<long>(this_process, 4), 0};
          while (nanosleep(&wait, &wait) != 0 && errno == EINTR)
            ;
        }
      if (write(STDERR_FILENO, text, std::strlen(text)) < 0)
        _exit(2);
      _exit(1);
    }
  } // namespace
} // namespace greville

extern "C"
{
  static void
  greville_catch_fault(const int signal, siginfo_t *info, void *)
  {
    using namespace greville;
    for (std::size_t k = 0; k < fault_signals.size(); ++k)
      if (fault_signals[k].signal == signal)
        {
          if (call_under_way)
            end_process(
              signal == SIGSEGV &&
                  call_under_way->memory.is_beyond(info->si_addr)
                ? "has read or written far beyond its arguments (SIGSEGV)"
                : fault_signals[k].text);
          // The instruction that has failed is repeated, and fails again.
          sigaction(signal, &earlier_actions[k], nullptr);
          if (info->si_code <= 0)
            raise(signal);
        }
  }



  static void
  greville_look_at_calls(const int)
  {
    using namespace greville;
    if (call_under_way == nullptr)
      return;
    if (call_under_way->number != seen_call)
      n_looks = 0;
    seen_call          = call_under_way->number;
    const double limit = call_under_way->law.time_limit;
    if (limit > 0. && n_looks++ * clock_period >= limit)
      end_process("does not return within its 'Time limit'");
  }



  static void
  greville_catch_exit(const int status, void *)
  {
    if (greville::call_under_way == nullptr)
      return;
    std::fflush(nullptr);
    char text[100];
    std::snprintf(text,
                  sizeof(text),
                  "has ended the program by STOP or exit, with the status %d",
                  status);
    greville::end_process(text);
  }



  static void
  greville_catch_quick_exit()
  {
    if (greville::call_under_way != nullptr)
      greville::end_process("has ended the program by quick_exit");
  }
}

namespace greville
{
  void
  UmatCall::catch_faults(const Law &law)
  {
    static bool has_handlers = false;
    if (!has_handlers)
      {
        has_handlers = true;
        if (Utilities::MPI::job_supports_mpi())
          this_process = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
        stack_t stack = {};
        if (sigaltstack(nullptr, &stack) == 0 && (stack.ss_flags & SS_DISABLE))
          {
            stack.ss_sp    = stack_of_signals;
            stack.ss_size  = sizeof(stack_of_signals);
            stack.ss_flags = 0;
            sigaltstack(&stack, nullptr);
          }
        struct sigaction action = {};
        action.sa_sigaction     = greville_catch_fault;
        action.sa_flags         = SA_SIGINFO | SA_ONSTACK;
        sigemptyset(&action.sa_mask);
        for (std::size_t k = 0; k < fault_signals.size(); ++k)
          sigaction(fault_signals[k].signal, &action, &earlier_actions[k]);
        on_exit(greville_catch_exit, nullptr);
        at_quick_exit(greville_catch_quick_exit);
      }

    // Not the timer of alarm(), which others may use. System calls go on.
    const double period = 0.25 * law.time_limit;
    if (period == 0. || (clock_period > 0. && period >= clock_period))
      return;
    if (clock_period == 0.)
      {
        struct sigaction action = {};
        action.sa_handler       = greville_look_at_calls;
        action.sa_flags         = SA_RESTART | SA_ONSTACK;
        sigemptyset(&action.sa_mask);
        sigaction(clock_signal, &action, nullptr);
        struct sigevent event = {};
        event.sigev_notify    = SIGEV_SIGNAL;
        event.sigev_signo     = clock_signal;
        AssertThrow(timer_create(CLOCK_MONOTONIC, &event, &clock_of_calls) == 0,
                    ExcMessage("There is no timer for '" + law.section +
                               "/Time limit'."));
      }
    clock_period            = period;
    struct itimerspec every = {};
    every.it_value.tv_sec   = period;
    every.it_value.tv_nsec  = (period - every.it_value.tv_sec) * 1e9;
    every.it_interval       = every.it_value;
    timer_settime(clock_of_calls, 0, &every, nullptr);
  }



  UmatCall::UmatCall(const Law           &law,
                     const MaterialPoint *point,
                     const UmatMemory    &memory)
    : law(law)
    , point(point)
    , memory(memory)
    , number(++n_calls)
  {
    std::atomic_signal_fence(std::memory_order_seq_cst);
    call_under_way = this;
  }



  UmatCall::~UmatCall()
  {
    call_under_way = nullptr;
  }



  void
  UmatCall::write_message(char             *buffer,
                          const std::size_t size,
                          const char       *what) const
  {
    const auto place = [&](char *text, const std::size_t n) {
      if (point == nullptr)
        std::snprintf(text, n, "for the stiffness without an increment");
      else
        {
          char third[40] = "";
          if (point->dim == 3)
            std::snprintf(third, sizeof(third), ", %g", point->position[2]);
          std::snprintf(text,
                        n,
                        "at (%g, %g%s), t = %g s, step %g s",
                        point->position[0],
                        point->position[1],
                        third,
                        point->time - point->dt,
                        point->dt);
        }
    };
    char where[200];
    place(where, sizeof(where));
    std::snprintf(buffer,
                  size,
                  "the UMAT of '%s' %s (<%s>, call %llu %s)",
                  law.section.c_str(),
                  what,
                  law.library.c_str(),
                  static_cast<unsigned long long>(number),
                  where);
  }



  std::string
  UmatCall::message(const std::string &what)
  {
    if (call_under_way == nullptr)
      return "a UMAT " + what;
    std::string text(what.size() + call_under_way->law.section.size() +
                       call_under_way->law.library.size() + 400,
                     '\0');
    call_under_way->write_message(&text[0], text.size(), what.c_str());
    text.resize(std::strlen(text.c_str()));
    return text;
  }



  std::string
  UmatCall::caller()
  {
    return call_under_way == nullptr
             ? "a UMAT"
             : "the UMAT of '" + call_under_way->law.section + "'";
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>
#include <greville/base/foreign_call.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cfenv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <pthread.h>
#include <string>
#include <sys/syscall.h>
#include <unistd.h>
#ifdef __SSE__
#  include <xmmintrin.h>
#endif

namespace greville
{
  using namespace dealii;

  namespace
  {
    const ForeignCall *volatile call_under_way = nullptr;

    std::uint64_t n_calls = 0;

    unsigned int this_process = 0;

    // True if an ExitGuard exists; and if this process was forked by the code
    // of a call.
    volatile bool exit_is_fault = false, is_copy = false;

    struct Fault
    {
      int         signal;
      const char *text;
    };

    // Faults of memory and arithmetic come first.
    constexpr unsigned int          n_crashes     = 5;
    constexpr std::array<Fault, 12> fault_signals = {
      {{SIGSEGV, "has accessed invalid memory (SIGSEGV)"},
       {SIGBUS, "has accessed invalid memory (SIGBUS)"},
       {SIGFPE,
        "has divided by zero or done another invalid operation (SIGFPE)"},
       {SIGILL,
        "has executed an instruction that this processor lacks "
        "(SIGILL)"},
       {SIGABRT, "has aborted (SIGABRT)"},
       {SIGTRAP, "has hit a trap (SIGTRAP)"},
       {SIGSYS, "has made an unknown system call (SIGSYS)"},
       {SIGALRM, "has been ended by SIGALRM"},
       {SIGPIPE, "has been ended by SIGPIPE"},
       {SIGUSR2, "has been ended by SIGUSR2"},
       {SIGXCPU, "has been ended by SIGXCPU, a time limit"},
       {SIGXFSZ, "has been ended by SIGXFSZ, a limit of file size"}}};

    std::array<struct sigaction, fault_signals.size()> earlier_actions;

    // The last library of a user that was loaded, and the process that loaded
    // it.
    char  last_library[2048] = "";
    pid_t own_process        = 0;

    // A separate stack for signal handlers, since a law may have exhausted its
    // stack.
    char stack_of_signals[1 << 16];

    // The clock that detects endless calls: the time between two checks, s, and
    // the number of consecutive checks that found the same call.
    constexpr int clock_signal = SIGVTALRM;
    timer_t       clock_of_calls;
    double        clock_period = 0.;
    unsigned int  n_looks      = 0;
    std::uint64_t watched_call = 0;

    // The limits of the clock's period, s.
    constexpr double shortest_period = 1e-3, longest_period = 1e6;

    std::fenv_t control_of_program;

    // The thread that ends the process with a message.
    std::atomic<pid_t> ending_thread{0};



    /// End the process like _exit(), which this file replaces.
    [[noreturn]] void
    end_now(const int status)
    {
      for (;;)
        syscall(SYS_exit_group, status);
    }



    /// End the process with a message. If several processes have the same
    /// fault, the first one reports it, and MPI ends the others while they
    /// wait.
    [[noreturn]] void
    end_process_with(const char *text)
    {
      if (this_process > 0)
        {
          std::signal(SIGTERM, SIG_DFL);
          // mpirun takes up to a second or two on a busy machine.
          struct timespec wait = {1 + std::min<long>(this_process, 4), 0};
          while (nanosleep(&wait, &wait) != 0 && errno == EINTR)
            ;
        }
      end_now(write(STDERR_FILENO, text, std::strlen(text)) < 0 ? 2 : 1);
    }



    /// Report that the program crashes, with possible reasons.
    void
    report_crash(const char *what)
    {
      char text[4096];
      std::snprintf(text,
                    sizeof(text),
                    "%s: the program %s. It has loaded the library <%s>, "
                    "which may be the cause, or may have changed memory that "
                    "is not its own.\n",
                    program_invocation_short_name,
                    what,
                    last_library);
      if (write(STDERR_FILENO, text, std::strlen(text)) < 0)
        end_now(2);
    }



    /// End the process during a call.
    [[noreturn]] void
    end_process(const char *what)
    {
      // The timer's signals also reach the threads of MPI.
      const pid_t own   = syscall(SYS_gettid);
      pid_t       other = 0;
      if (!ending_thread.compare_exchange_strong(other, own))
        {
          while (other != own)
            pause();
          end_now(1);
        }
      char      text[4096];
      const int n = std::snprintf(
        text, sizeof(text) / 2, "%s: ", program_invocation_short_name);
      call_under_way->write_message(text + n, sizeof(text) - n - 2, what);
      std::strcat(text, ".\n");
      end_process_with(text);
    }



    /// Return the bits that control the processor's floating-point arithmetic,
    /// without the bits that report past exceptions.
    unsigned int
    floating_point_control()
    {
#ifdef __SSE__
      return _mm_getcsr() & ~unsigned(_MM_EXCEPT_MASK);
#else
      return 0;
#endif
    }



    unsigned int bits_of_program = 0;
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
              signal == SIGSEGV && call_under_way->is_beyond(info->si_addr)
                ? "has read or written far beyond its arguments (SIGSEGV)"
                : fault_signals[k].text);
          if (k < n_crashes && last_library[0] != '\0')
            report_crash(fault_signals[k].text);
          // On return, the failed instruction runs again under the earlier
          // handler.
          sigaction(signal, &earlier_actions[k], nullptr);
          if (info->si_code <= 0 || k >= n_crashes)
            raise(signal);
        }
  }



  static void
  greville_look_at_calls(const int)
  {
    using namespace greville;
    if (call_under_way == nullptr)
      return;
    if (call_under_way->call_number != watched_call)
      n_looks = 0;
    watched_call       = call_under_way->call_number;
    const double limit = call_under_way->time_limit;
    if (limit > 0. && n_looks++ * clock_period >= limit)
      end_process(call_under_way->text_of_limit());
  }



  static void
  greville_catch_exit(const int status, void *)
  {
    using namespace greville;
    if (call_under_way == nullptr && !exit_is_fault)
      return;
    std::fflush(nullptr);
    char text[100];
    std::snprintf(text,
                  sizeof(text),
                  "has ended the program by STOP or exit, with the status %d",
                  status);
    if (call_under_way)
      end_process(text);
    std::string message = program_invocation_short_name;
    message += std::string(": a library ") + text;
    if (last_library[0] != '\0')
      message += std::string(" (the last one that has been loaded is <") +
                 last_library + ">)";
    end_process_with((message + ".\n").c_str());
  }



  /// Replaces the function of the system, also for loaded libraries: otherwise,
  /// a UMAT could end the program with the status 0 and without a message.
  __attribute__((noreturn)) void
  _exit(const int status)
  {
    using namespace greville;
    if (call_under_way && getpid() == own_process)
      {
        char text[100];
        std::snprintf(text,
                      sizeof(text),
                      "has ended the program by _exit, with the status %d",
                      status);
        end_process(text);
      }
    end_now(status);
  }



  __attribute__((noreturn)) void
  _Exit(const int status)
  {
    _exit(status);
  }



  static void
  greville_catch_quick_exit()
  {
    if (greville::call_under_way != nullptr)
      greville::end_process("has ended the program by quick_exit");
  }



  static void
  greville_catch_fork()
  {
    greville::is_copy        = greville::call_under_way != nullptr;
    greville::call_under_way = nullptr;
    greville::exit_is_fault  = false;
  }
}

namespace greville
{
  void
  ForeignCall::catch_faults(const double time_limit)
  {
    static bool has_handlers = false;
    if (!has_handlers)
      {
        has_handlers = true;
        own_process  = getpid();
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
          {
            const int signal = fault_signals[k].signal;
            sigaction(signal, nullptr, &earlier_actions[k]);
            // Handlers set by others are kept.
            if (k < n_crashes || earlier_actions[k].sa_handler == SIG_DFL)
              sigaction(signal, &action, nullptr);
          }
        on_exit(greville_catch_exit, nullptr);
        at_quick_exit(greville_catch_quick_exit);
        pthread_atfork(nullptr, nullptr, greville_catch_fork);
        std::fegetenv(&control_of_program);
        bits_of_program = floating_point_control();
      }

    // This is not the timer of alarm(), which others may use. System calls are
    // restarted.
    if (!(time_limit > 0.))
      return;
    const double period =
      std::clamp(0.25 * time_limit, shortest_period, longest_period);
    if (clock_period > 0. && period >= clock_period)
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
        Require(timer_create(CLOCK_MONOTONIC, &event, &clock_of_calls) == 0,
                "There is no timer for the time limit of calls of a library.");
      }
    clock_period            = period;
    struct itimerspec every = {};
    every.it_value.tv_sec   = period;
    every.it_value.tv_nsec  = (period - every.it_value.tv_sec) * 1e9;
    every.it_interval       = every.it_value;
    timer_settime(clock_of_calls, 0, &every, nullptr);
  }



  ForeignCall::ForeignCall(const double time_limit)
    : time_limit(time_limit)
    , call_number(++n_calls)
  {
    std::atomic_signal_fence(std::memory_order_seq_cst);
    call_under_way = this;
  }



  ForeignCall::~ForeignCall()
  {
    // The forked process continues.
    if (is_copy)
      end_now(0);
    call_under_way = nullptr;
    if (floating_point_control() != bits_of_program)
      std::fesetenv(&control_of_program);
  }



  void
  ForeignCall::remember_library(const std::string &file)
  {
    std::snprintf(last_library, sizeof(last_library), "%s", file.c_str());
  }



  std::string
  ForeignCall::library()
  {
    return last_library;
  }



  const ForeignCall *
  ForeignCall::under_way()
  {
    return call_under_way;
  }



  ExitGuard::ExitGuard()
  {
    static const int is_caught = on_exit(greville_catch_exit, nullptr);
    exit_is_fault              = is_caught == 0;
  }



  ExitGuard::~ExitGuard()
  {
    release();
  }



  void
  ExitGuard::release()
  {
    exit_is_fault = false;
  }
} // namespace greville

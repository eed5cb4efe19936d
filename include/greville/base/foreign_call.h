// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace greville
{
  /**
   * A call of code in a user's library, such as a UMAT or the initializers of a
   * library. During the lifetime of the object, a call of exit() or _exit()
   * (STOP in Fortran), a signal such as SIGSEGV, and a call that exceeds its
   * time limit end the process with one message and the exit status 1; MPI then
   * ends the others. A process forked by the code ends on return. Afterwards,
   * the program's floating-point settings (traps, rounding, denormals) are
   * restored.
   *
   * Only one call exists at a time, and each process has one thread.
   */
  class ForeignCall
  {
  public:
    /// Let faults in calls end the process. Call this before calls with the
    /// time limit @p time_limit, s; 0 stands for no limit.
    static void
    catch_faults(const double time_limit);

    /// Name the library @p file in messages about crashes outside calls.
    static void
    remember_library(const std::string &file);

    /// Return the last library of remember_library(), empty if there is none.
    static std::string
    library();

    ForeignCall(const double time_limit);

    virtual ~ForeignCall();

    ForeignCall(const ForeignCall &) = delete;

    ForeignCall &
    operator=(const ForeignCall &) = delete;

    /// Write the message that the code @p what, such as "has aborted", to a
    /// @p buffer of @p size letters. For signal handlers: allocates no memory.
    virtual void
    write_message(char             *buffer,
                  const std::size_t size,
                  const char       *what) const = 0;

    /// Return whether an @p address is in the memory around the arguments of
    /// the call.
    virtual bool
    is_beyond(const void * /*address*/) const
    {
      return false;
    }

    /// Return the message about a call that exceeds its time limit.
    virtual const char *
    text_of_limit() const = 0;

    /// Return the current call, or a null pointer.
    static const ForeignCall *
    under_way();

    /// The time limit of the call, s, or 0 if there is none.
    const double time_limit;
    /// A number that identifies the call on its process.
    std::uint64_t call_number;
  };



  /// A guard during the lifetime of the program: a library that calls exit()
  /// outside a ForeignCall, for instance in a thread or in a law of a plugin,
  /// ends the process with a message and the exit status 1.
  class ExitGuard
  {
  public:
    ExitGuard();

    ~ExitGuard();

    ExitGuard(const ExitGuard &) = delete;

    ExitGuard &
    operator=(const ExitGuard &) = delete;

    /// Allow exit() to end the process, after the program has reported the
    /// reason.
    static void
    release();
  };
} // namespace greville

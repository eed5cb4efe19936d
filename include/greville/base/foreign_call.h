// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_foreign_call_h
#define greville_base_foreign_call_h

#include <cstddef>
#include <cstdint>
#include <string>

namespace greville
{
  /**
   * Exists while code of a user's library runs, such as a UMAT or the
   * initializers of a library that is loaded. Meanwhile a call of exit() or
   * _exit() (STOP in Fortran), a signal such as SIGSEGV, and a call that takes
   * longer than its time limit end the process with one message and the exit
   * status 1; MPI then ends the others. A process that the code has forked ends
   * where it returns. The control of floating point numbers (traps, rounding,
   * denormals) is that of the program again afterwards.
   *
   * There is one at a time, and processes have one thread each.
   */
  class ForeignCall
  {
  public:
    /**
     * Let faults in calls end the process. Before calls whose time limit (s) is
     * @p time_limit; 0 is none.
     */
    static void
    catch_faults(const double time_limit);

    /**
     * Let messages of crashes outside of calls name a library.
     */
    static void
    remember_library(const std::string &file);

    /**
     * The last one, empty if there is none.
     */
    static std::string
    library();

    ForeignCall(const double time_limit);

    virtual ~ForeignCall();

    ForeignCall(const ForeignCall &) = delete;

    ForeignCall &
    operator=(const ForeignCall &) = delete;

    /**
     * Write a message that the code @p what, such as "has aborted", to a @p
     * buffer of @p size letters, without memory from the heap: for handlers of
     * signals.
     */
    virtual void
    write_message(char             *buffer,
                  const std::size_t size,
                  const char       *what) const = 0;

    /**
     * Return whether an @p address lies beside the arguments of the call.
     */
    virtual bool
    is_beyond(const void * /*address*/) const
    {
      return false;
    }

    /**
     * Return the message about a call that takes longer than its time limit.
     */
    virtual const char *
    text_of_limit() const = 0;

    /**
     * Return the call under way, or a null pointer.
     */
    static const ForeignCall *
    under_way();

    /// The longest time of the call, s, or 0 if there is none.
    const double time_limit;
    /// Different for all calls of a process.
    std::uint64_t stamp;
  };



  /**
   * Exists while the program runs: a library that calls exit() outside of a
   * ForeignCall, as a thread of it or a law of a plugin may do, ends the
   * process with a message and the exit status 1.
   */
  class ExitGuard
  {
  public:
    ExitGuard();

    ~ExitGuard();

    ExitGuard(const ExitGuard &) = delete;

    ExitGuard &
    operator=(const ExitGuard &) = delete;

    /**
     * Let exit() end the process: the program has said why.
     */
    static void
    release();
  };
} // namespace greville

#endif

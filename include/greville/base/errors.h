#ifndef greville_base_errors_h
#define greville_base_errors_h

#include <deal.II/base/mpi.h>

#include <exception>
#include <functional>
#include <string>

namespace greville
{
  /**
   * The message of an exception in one paragraph, without the decoration that
   * deal.II puts around it.
   */
  std::string
  message_of(const std::exception &exception);

  /**
   * Collective. Throw dealii::ExcMessage on all processes with the message of
   * the first process whose @p message is not empty, if there is one. Without
   * it an error of a single process leaves the others waiting.
   */
  void
  throw_on_all(const std::string &message, const MPI_Comm comm);

  /**
   * Collective. Call @p action, which must not communicate, and throw on all
   * processes what it throws on any.
   */
  void
  run_on_all(const std::function<void()> &action, const MPI_Comm comm);
} // namespace greville

#endif

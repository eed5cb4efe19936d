// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_errors_h
#define greville_base_errors_h

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

namespace greville
{
  /**
   * The message of an exception in one paragraph, without the decoration that
   * deal.II puts around it.
   */
  std::string
  message_of(const std::exception &exception);

  /**
   * A value as a stream writes it.
   */
  template <typename T>
  std::string
  text_of(const T &value)
  {
    std::ostringstream text;
    text << value;
    return text.str();
  }

  /**
   * A number with as many @p digits at most.
   */
  inline std::string
  rounded(const double value, const unsigned int digits = 4)
  {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    return text.str();
  }

  /**
   * " Did you mean <lumped>?" where a word of @p known is close to @p word,
   * and nothing otherwise.
   */
  std::string
  did_you_mean(const std::string &word, const std::vector<std::string> &known);

  /**
   * Collective. The message of the first process whose @p message is not empty,
   * or an empty one.
   */
  std::string
  first_of_all(const std::string &message, const MPI_Comm comm);

  /**
   * What throw_on_all() throws: all processes have it, and may go on together.
   */
  class ErrorOnAll : public dealii::ExcMessage
  {
  public:
    using dealii::ExcMessage::ExcMessage;
  };

  /**
   * Collective. Throw ErrorOnAll on all processes with the message of
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

  /**
   * Collective. Call @p action on the first process, and throw on all what it
   * throws.
   */
  void
  run_on_first(const std::function<void()> &action, const MPI_Comm comm);

  /**
   * Throw dealii::ExcMessage where a list that the @p parameter gives has
   * something twice.
   */
  template <typename T>
  void
  check_different(const std::vector<T> &entries,
                  const std::string    &parameter,
                  const std::string    &what = "entry")
  {
    for (auto entry = entries.begin(); entry != entries.end(); ++entry)
      AssertThrow(std::find(entries.begin(), entry, *entry) == entry,
                  dealii::ExcMessage("The parameter '" + parameter +
                                     "' has the " + what + " <" +
                                     text_of(*entry) + "> twice."));
  }
} // namespace greville

#endif

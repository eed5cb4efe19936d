// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

/// Throw dealii::ExcMessage with a message (a std::string) for users, unless
/// the condition holds. The message is made only then.
#define Require(condition, ...) \
  AssertThrow(condition, dealii::ExcMessage(__VA_ARGS__))

namespace greville
{
  /// Return the message of an exception in one paragraph, without deal.II's
  /// decoration.
  std::string
  message_of(const std::exception &exception);

  /// Return a value as text, as written by a stream.
  template <typename T>
  std::string
  text_of(const T &value)
  {
    std::ostringstream text;
    text << value;
    return text.str();
  }

  /// Return a number with at most @p digits digits.
  inline std::string
  rounded(const double value, const unsigned int digits = 4)
  {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    return text.str();
  }

  template <typename List, typename T>
  bool
  contains(const List &list, const T &entry)
  {
    return std::find(std::begin(list), std::end(list), entry) != std::end(list);
  }

  /// Return the keys of a map in their order.
  template <typename Map>
  std::vector<std::string>
  keys_of(const Map &map)
  {
    std::vector<std::string> keys;
    for (const auto &entry : map)
      keys.push_back(entry.first);
    return keys;
  }

  /// Return " Did you mean <lumped>?" if @p known contains a word close to
  /// @p word, otherwise an empty text.
  std::string
  did_you_mean(const std::string &word, const std::vector<std::string> &known);

  /// Collective. Return the message of the first process whose @p message is
  /// not empty, or an empty text.
  std::string
  first_of_all(const std::string &message, const MPI_Comm comm);

  /// The exception of throw_on_all(), which all processes catch and after which
  /// they may continue together.
  class ErrorOnAll : public dealii::ExcMessage
  {
  public:
    using dealii::ExcMessage::ExcMessage;
  };

  /// Collective. Throw ErrorOnAll on all processes with the message of the
  /// first process whose @p message is not empty, if there is one. Otherwise,
  /// an error of a single process would leave the others waiting.
  void
  throw_on_all(const std::string &message, const MPI_Comm comm);

  /// Collective. Call @p action, which must not communicate. If it throws on
  /// any process, throw its exception on all processes.
  void
  run_on_all(const MPI_Comm comm, const std::function<void()> &action);

  /// Collective. Call @p action on the first process, and throw its exception
  /// on all processes.
  void
  run_on_first(const MPI_Comm comm, const std::function<void()> &action);

  /// Throw dealii::ExcMessage if a list given by the @p parameter contains an
  /// entry twice.
  template <typename T>
  void
  check_different(const std::vector<T> &entries,
                  const std::string    &parameter,
                  const std::string    &what = "entry")
  {
    for (auto entry = entries.begin(); entry != entries.end(); ++entry)
      Require(std::find(entries.begin(), entry, *entry) == entry,
              "The parameter '" + parameter + "' has the " + what + " <" +
                text_of(*entry) + "> twice.");
  }
} // namespace greville

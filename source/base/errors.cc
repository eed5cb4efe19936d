// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace greville
{
  using namespace dealii;

  std::string
  message_of(const std::exception &exception)
  {
    const auto *dealii_exception =
      dynamic_cast<const ExceptionBase *>(&exception);
    std::ostringstream text;
    if (dealii_exception != nullptr)
      dealii_exception->print_info(text);
    else
      text << exception.what();

    // deal.II breaks and indents lines.
    std::istringstream words(text.str());
    std::string        word, result;
    while (words >> word)
      result += (result.empty() ? "" : " ") + word;
    // Shorten the message: a value may be as long as its file.
    constexpr std::size_t begin = 2000, end = 1000;
    if (result.size() > 2 * begin)
      result = result.substr(0, begin) + " ... (" +
               std::to_string(result.size() - begin - end) +
               " letters are left out) ... " +
               result.substr(result.size() - end);
    return result;
  }



  namespace
  {
    /// Return the number of letters to insert, remove, replace or swap with
    /// their neighbour to turn one word into the other.
    unsigned int
    distance(const std::string &a, const std::string &b)
    {
      std::vector<std::vector<unsigned int>> d(
        a.size() + 1, std::vector<unsigned int>(b.size() + 1));
      for (unsigned int i = 0; i <= a.size(); ++i)
        for (unsigned int j = 0; j <= b.size(); ++j)
          {
            if (i == 0 || j == 0)
              {
                d[i][j] = i + j;
                continue;
              }
            const bool same =
              std::tolower(static_cast<unsigned char>(a[i - 1])) ==
              std::tolower(static_cast<unsigned char>(b[j - 1]));
            d[i][j] = std::min(
              {d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + !same});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
              d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
          }
      return d[a.size()][b.size()];
    }
  } // namespace



  std::string
  did_you_mean(const std::string &word, const std::vector<std::string> &known)
  {
    std::string  nearest;
    unsigned int smallest_distance =
      std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string &other : known)
      {
        const unsigned int d = distance(word, other);
        if (d < smallest_distance && d < other.size())
          {
            smallest_distance = d;
            nearest           = other;
          }
      }
    return nearest.empty() ? "" : " Did you mean <" + nearest + ">?";
  }



  std::string
  first_of_all(const std::string &message, const MPI_Comm comm)
  {
    // Name the process with the message, without a list of other messages.
    const unsigned int n     = Utilities::MPI::n_mpi_processes(comm);
    const unsigned int first = Utilities::MPI::min(
      message.empty() ? n : Utilities::MPI::this_mpi_process(comm), comm);
    return first == n ? "" : Utilities::MPI::broadcast(comm, message, first);
  }



  void
  throw_on_all(const std::string &message, const MPI_Comm comm)
  {
    const std::string first = first_of_all(message, comm);
    AssertThrow(first.empty(), ErrorOnAll(first));
  }



  void
  run_on_all(const MPI_Comm comm, const std::function<void()> &action)
  {
    std::string message;
    try
      {
        action();
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    throw_on_all(message, comm);
  }



  void
  run_on_first(const MPI_Comm comm, const std::function<void()> &action)
  {
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      run_on_all(comm, action);
    else
      throw_on_all("", comm);
  }
} // namespace greville

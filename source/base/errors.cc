#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>

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

    // deal.II breaks lines and indents them.
    std::istringstream words(text.str());
    std::string        word, result;
    while (words >> word)
      result += (result.empty() ? "" : " ") + word;
    return result;
  }



  void
  throw_on_all(const std::string &message, const MPI_Comm comm)
  {
    if (Utilities::MPI::max(int(!message.empty()), comm) == 0)
      return;
    for (const std::string &m : Utilities::MPI::all_gather(comm, message))
      AssertThrow(m.empty(), ExcMessage(m));
  }



  void
  run_on_all(const std::function<void()> &action, const MPI_Comm comm)
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
} // namespace greville

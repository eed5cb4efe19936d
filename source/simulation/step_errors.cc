// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/step_errors.h>

namespace greville
{
  using namespace dealii;

  void
  fail_on_all(const std::string &message,
              const MPI_Comm     comm,
              const bool         by_materials)
  {
    if (Utilities::MPI::max<unsigned int>(!message.empty(), comm) == 0)
      return;
    for (const std::string &m : Utilities::MPI::all_gather(comm, message))
      if (!m.empty())
        throw StepFailed(m, by_materials);
  }
} // namespace greville

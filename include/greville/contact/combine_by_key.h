// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <map>
#include <unordered_map>
#include <vector>

namespace greville
{
  /// Collective. Replace each of the @p values by the sum over all processes
  /// for its key: @p add(sum, value) adds one value. The key modulo the number
  /// of processes is the process that computes the sum.
  template <typename Value, typename Add>
  void
  combine_by_key(std::unordered_map<std::uint64_t, Value> &values,
                 const Add                                &add,
                 const MPI_Comm                            comm)
  {
    const unsigned int n = dealii::Utilities::MPI::n_mpi_processes(comm);
    if (n == 1)
      return;
    using Rows = std::vector<std::pair<std::uint64_t, Value>>;
    std::map<unsigned int, Rows> to_owners, answers;
    for (const auto &entry : values)
      to_owners[entry.first % n].push_back(entry);
    const auto received = dealii::Utilities::MPI::some_to_some(comm, to_owners);
    std::unordered_map<std::uint64_t, Value> owned;
    for (const auto &[process, rows] : received)
      for (const auto &[key, value] : rows)
        {
          const auto [found, is_first] = owned.emplace(key, value);
          if (!is_first)
            add(found->second, value);
        }
    for (const auto &[process, rows] : received)
      for (const auto &row : rows)
        answers[process].emplace_back(row.first, owned.at(row.first));
    for (const auto &[process, rows] :
         dealii::Utilities::MPI::some_to_some(comm, answers))
      for (const auto &[key, sum] : rows)
        values[key] = sum;
  }
} // namespace greville

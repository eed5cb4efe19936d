// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

/// Checks of 32-bit limits: numbers in libraries that are built with 32-bit
/// indices, and the lengths of messages, which MPI counts by int.
namespace greville
{
  /// Return @p number as an Index of a library. Throws dealii::ExcMessage with
  /// the description @p what if the Index has too few bits for it.
  template <typename Index>
  Index
  checked_index(const std::uint64_t number, const std::string &what)
  {
    constexpr std::uint64_t limit = std::numeric_limits<Index>::max();
    Require(number <= limit,
            std::to_string(number) + " " + what +
              " are more than the libraries can number here, at most " +
              std::to_string(limit) +
              ": use a coarser grid, or a PETSc and a deal.II with 64-bit "
              "indices (DEAL_II_WITH_64BIT_INDICES).");
    return Index(number);
  }



  /// Throw dealii::ExcMessage if a message of @p n_bytes is too long for
  /// deal.II and MPI. Data packed by Boost (@p is_packed) may be longer.
  inline void
  check_message_size(const std::uint64_t n_bytes, const bool is_packed)
  {
    const std::uint64_t limit =
      std::numeric_limits<int>::max() / (is_packed ? 2 : 1) - 1024;
    Require(n_bytes <= limit,
            "A message of " + std::to_string(n_bytes) +
              " bytes from one process to another is longer than MPI can "
              "count, at most " +
              std::to_string(limit) + ": use more processes.");
  }



  /// Collective. Return the sum of @p number over the processes before this
  /// one.
  inline std::uint64_t
  sum_before(const std::uint64_t number, const MPI_Comm comm)
  {
    std::uint64_t sum = 0;
    const int ierr = MPI_Exscan(&number, &sum, 1, MPI_UINT64_T, MPI_SUM, comm);
    AssertThrowMPI(ierr);
    // MPI leaves the result on the first process undefined.
    return dealii::Utilities::MPI::this_mpi_process(comm) == 0 ? 0 : sum;
  }



  /// Collective. Call dealii::Utilities::MPI::some_to_some() for lists, and
  /// throw if they are too long for a message.
  template <typename T>
  std::map<unsigned int, std::vector<T>>
  exchange_lists(const MPI_Comm                                comm,
                 const std::map<unsigned int, std::vector<T>> &lists)
  {
    for (const auto &list : lists)
      check_message_size(list.second.size() * sizeof(T),
                         !std::is_trivially_copyable_v<T>);
    return dealii::Utilities::MPI::some_to_some(comm, lists);
  }
} // namespace greville

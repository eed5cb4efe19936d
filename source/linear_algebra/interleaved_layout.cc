// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/linear_algebra/interleaved_layout.h>

#include <algorithm>
#include <string>

namespace greville
{
  using namespace dealii;

  const std::shared_ptr<const Utilities::MPI::Partitioner> &
  InterleavedLayout::partitioner(const unsigned int width) const
  {
    auto &result = partitioners[width];
    if (result)
      return result;
    constexpr std::uint64_t largest_index = types::global_dof_index(-1);
    Require(std::uint64_t(n_all) * width < largest_index,
            std::to_string(n_all) + " functions with " + std::to_string(width) +
              " values each are more than this deal.II can number, at most " +
              std::to_string(largest_index) +
              ": use a coarser grid, a 'Scheme/Mass' other than exact mass, or "
              "a deal.II with 64-bit indices.");
    // deal.II divides by the size, which must not be zero.
    const types::global_dof_index size =
      std::max<types::global_dof_index>(1, n_all * width);
    IndexSet owned(size), others(size);
    owned.add_range(first * width, (first + n_own) * width);
    for (const auto ghost : ghosts)
      others.add_range(ghost * width, (ghost + 1) * width);
    result =
      std::make_shared<const Utilities::MPI::Partitioner>(owned, others, comm);
    return result;
  }



  JoinedLayout::JoinedLayout(
    const std::vector<const InterleavedLayout *> &parts)
  {
    using Number        = types::global_dof_index;
    const MPI_Comm comm = parts.front()->communicator();
    // The first owned unknown and the number of owned unknowns of each part.
    std::vector<std::pair<Number, Number>> own;
    for (const InterleavedLayout *part : parts)
      own.emplace_back(part->n_owned() > 0 ? part->global_number(0) : 0,
                       part->n_owned());
    const auto of_processes = Utilities::MPI::all_gather(comm, own);

    struct Ghost
    {
      Number       number;
      unsigned int part, local;
    };
    std::vector<Ghost> ghosts;
    for (unsigned int k = 0; k < parts.size(); ++k)
      {
        unsigned int g     = parts[k]->n_owned();
        Number       begin = 0;
        for (const auto &of_process : of_processes)
          {
            const auto &[first, n] = of_process[k];
            Number before          = begin;
            for (unsigned int j = 0; j < k; ++j)
              before += of_process[j].second;
            for (; g < parts[k]->n_local() && n > 0 &&
                   parts[k]->global_number(g) < first + n;
                 ++g)
              ghosts.push_back(
                {before + (parts[k]->global_number(g) - first), k, g});
            for (const auto &of_part : of_process)
              begin += of_part.second;
          }
      }
    std::sort(ghosts.begin(), ghosts.end(), [](const Ghost &a, const Ghost &b) {
      return a.number < b.number;
    });
    unsigned int        n_owned = 0;
    std::vector<Number> ghost_numbers;
    for (const InterleavedLayout *part : parts)
      {
        numbers.emplace_back(part->n_local());
        for (unsigned int u = 0; u < part->n_owned(); ++u)
          numbers.back()[u] = n_owned++;
      }
    for (const Ghost &ghost : ghosts)
      {
        numbers[ghost.part][ghost.local] = n_owned + ghost_numbers.size();
        ghost_numbers.push_back(ghost.number);
      }
    Number first = 0;
    for (unsigned int process = 0;
         process < Utilities::MPI::this_mpi_process(comm);
         ++process)
      for (const auto &of_part : of_processes[process])
        first += of_part.second;
    layout = InterleavedLayout(first, n_owned, ghost_numbers, comm);
  }
} // namespace greville

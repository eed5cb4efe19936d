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
    // deal.II divides by the size, even if no process owns anything.
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
} // namespace greville

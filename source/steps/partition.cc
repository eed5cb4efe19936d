// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/mixed_bits.h>
#include <greville/steps/partition.h>

#include <array>

namespace greville
{
  using namespace dealii;

  Partition::Partition(std::vector<double>                        rows_,
                       const MPI_Comm                             comm,
                       const std::shared_ptr<const RefinedCells> &cells)
    : rows(std::move(rows_))
    , cells(cells)
  {
    Require(rows.size() % 2 == 0,
            "a row of a partition has a cell and a weight");
    std::array<std::uint64_t, 2> sums{{rows.size() / 2, 0}};
    for (std::size_t k = 0; k < rows.size(); k += 2)
      sums[1] += mixed_bits(mixed_bits(std::uint64_t(rows[k])) +
                            std::uint64_t(rows[k + 1]));
    // The sum of checksums may overflow: unsigned numbers wrap around.
    std::array<std::uint64_t, 2> all{};
    const int                    ierr =
      MPI_Allreduce(sums.data(), all.data(), 2, MPI_UINT64_T, MPI_SUM, comm);
    AssertThrowMPI(ierr);
    n_rows   = all[0];
    checksum = all[1];
  }
} // namespace greville

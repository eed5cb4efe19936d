// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/simd.h>
#include <greville/spline/cell_batches.h>

#include <algorithm>
#include <tuple>

namespace greville
{
  template <int dim>
  unsigned int
  CellBatches<dim>::width()
  {
    return native_simd_width;
  }



  template <int dim>
  std::vector<typename CellBatches<dim>::Batch>
  CellBatches<dim>::make(const SplineSpace<dim> &space)
  {
    std::vector<Batch> batches;
    const auto        &cells   = space.owned_cells();
    const auto        &extents = space.lattice().n_cells();

    unsigned int begin = 0;
    while (begin < cells.size())
      {
        // Find the run of neighbours in x that starts here.
        const auto   index = multi_index<dim>(cells[begin], extents);
        unsigned int end   = begin + 1;
        while (end < cells.size() && cells[end] == cells[end - 1] + 1 &&
               cells[end] % extents[0] != 0)
          ++end;

        for (unsigned int first = begin; first < end;
             first += native_simd_width)
          {
            Batch batch{
              first, 0, std::min(native_simd_width, end - first), index, false};
            // A full batch is faster than a partial one, so it begins earlier.
            if (batch.end_lane < native_simd_width &&
                end - begin >= native_simd_width)
              {
                batch.first_lane = native_simd_width - batch.end_lane;
                batch.end_lane   = native_simd_width;
                batch.first_cell = end - native_simd_width;
              }
            batch.index[0] += batch.first_cell - begin;
            batches.push_back(batch);
          }
        begin = end;
      }

    const auto column = [](const Batch &batch) {
      return std::make_tuple(batch.index[0],
                             batch.first_lane,
                             batch.end_lane,
                             dim == 3 ? batch.index[1] : 0);
    };
    const auto height = [](const Batch &batch) { return batch.index[dim - 1]; };
    std::sort(batches.begin(),
              batches.end(),
              [&](const Batch &a, const Batch &b) {
                return std::make_pair(column(a), height(a)) <
                       std::make_pair(column(b), height(b));
              });
    for (std::size_t b = 1; b < batches.size(); ++b)
      batches[b].continues_column =
        column(batches[b]) == column(batches[b - 1]) &&
        height(batches[b]) == height(batches[b - 1]) + 1;
    return batches;
  }



  GREVILLE_INSTANTIATE_CLASS(CellBatches);
} // namespace greville

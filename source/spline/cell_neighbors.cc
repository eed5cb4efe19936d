// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/cell_neighbors.h>

#include <algorithm>
#include <map>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  CellNeighbors<dim>::reinit(const SplineSpace<dim> &space)
  {
    cells   = space.owned_cells();
    lattice = space.lattice();
    n_owned = cells.size();
    numbers.clear();
    ghost_places.clear();
    sent.clear();
    if (Utilities::MPI::n_mpi_processes(space.communicator()) == 1)
      {
        if (lattice.hierarchy())
          sort_cells();
        return;
      }

    const auto &tria       = space.triangulation();
    const auto partitioner = tria.global_active_cell_index_partitioner().lock();
    buffer.reinit(partitioner);
    std::vector<bool> is_sent(buffer.locally_owned_size(), false);
    for (const auto &range : partitioner->import_indices())
      std::fill(is_sent.begin() + range.first,
                is_sent.begin() + range.second,
                true);
    std::map<std::uint64_t, unsigned int> ghosts; // any child of a parent
    for (const auto &cell : tria.active_cell_iterators())
      {
        if (cell->is_artificial())
          continue;
        const unsigned int place =
          partitioner->global_to_local(cell->global_active_cell_index());
        if (!cell->is_locally_owned())
          ghosts[space.cell_position(cell->center())] = place;
        else if (is_sent[place])
          sent.emplace_back(space.cell_number(cell), place);
      }
    for (const auto &ghost : ghosts)
      {
        cells.push_back(ghost.first);
        ghost_places.push_back(ghost.second);
      }
    sort_cells();
  }



  template <int dim>
  void
  CellNeighbors<dim>::sort_cells()
  {
    for (unsigned int c = 0; c < cells.size(); ++c)
      numbers.emplace_back(cells[c], c);
    std::sort(numbers.begin(), numbers.end());
    line_begin.clear();
    const std::uint64_t n_x = lattice.n_cells()[0];
    first_line              = numbers.empty() ? 0 : numbers[0].first / n_x;
    for (unsigned int k = 0; k < numbers.size(); ++k)
      line_begin.resize(numbers[k].first / n_x - first_line + 1, k);
    line_begin.push_back(numbers.size());
  }



  template <int dim>
  unsigned int
  CellNeighbors<dim>::find(const std::uint64_t position) const
  {
    if (numbers.empty() && buffer.size() == 0) // all cells of one process
      return position;
    const std::uint64_t line = position / lattice.n_cells()[0] - first_line;
    if (line >= line_begin.size() - 1)
      return dealii::numbers::invalid_unsigned_int;
    const auto begin = numbers.begin() + line_begin[line],
               end   = numbers.begin() + line_begin[line + 1];
    const auto is_at = [&](const auto &entry) {
      return entry != end && entry->first == position;
    };
    // Most lines have no gaps.
    auto found = begin;
    if (begin != end && position >= begin->first)
      found += std::min<std::uint64_t>(position - begin->first, end - begin);
    if (!is_at(found))
      found = std::lower_bound(begin, end, std::make_pair(position, 0u));
    return is_at(found) ? found->second : dealii::numbers::invalid_unsigned_int;
  }



  template <int dim>
  unsigned int
  CellNeighbors<dim>::neighbor(const unsigned int cell,
                               const unsigned int side) const
  {
    auto index = multi_index<dim>(cells[cell], lattice.n_cells());
    index[side / 2] += side % 2 == 0 ? -1 : 1;
    return lattice.wrap(index)
             ? find(lexicographic<dim>(index, lattice.n_cells()))
             : dealii::numbers::invalid_unsigned_int;
  }



  GREVILLE_INSTANTIATE_CLASS(CellNeighbors);
} // namespace greville

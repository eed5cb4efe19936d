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
    buffer_places.clear();
    if (Utilities::MPI::n_mpi_processes(space.communicator()) == 1)
      return;

    const auto &tria       = space.triangulation();
    const auto partitioner = tria.global_active_cell_index_partitioner().lock();
    buffer.reinit(partitioner);
    buffer_places.resize(n_owned);
    of_children.clear();
    std::map<std::uint64_t, unsigned int> ghosts; // any child of a parent
    for (const auto &cell : tria.active_cell_iterators())
      {
        if (cell->is_artificial())
          continue;
        const unsigned int place =
          partitioner->global_to_local(cell->global_active_cell_index());
        if (cell->is_locally_owned())
          {
            buffer_places[space.cell_number(cell)] = place;
            of_children.emplace_back(space.cell_number(cell), place);
          }
        else
          ghosts[space.cell_position(cell->center())] = place;
      }
    for (const auto &ghost : ghosts)
      {
        cells.push_back(ghost.first);
        buffer_places.push_back(ghost.second);
      }
    for (unsigned int c = 0; c < cells.size(); ++c)
      numbers.emplace_back(cells[c], c);
    std::sort(numbers.begin(), numbers.end());
  }



  template <int dim>
  unsigned int
  CellNeighbors<dim>::find(const std::uint64_t position) const
  {
    if (numbers.empty()) // one process: all cells
      return position;
    const auto found = std::lower_bound(numbers.begin(),
                                        numbers.end(),
                                        std::make_pair(position, 0u));
    return found != numbers.end() && found->first == position
             ? found->second
             : dealii::numbers::invalid_unsigned_int;
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



  template <int dim>
  void
  CellNeighbors<dim>::exchange(std::vector<double> &values) const
  {
    AssertThrow(values.size() == cells.size(),
                ExcDimensionMismatch(values.size(), cells.size()));
    if (buffer.size() == 0) // one process
      return;
    buffer.zero_out_ghost_values();
    for (const auto &child : of_children)
      buffer.local_element(child.second) = values[child.first];
    buffer.update_ghost_values();
    for (unsigned int c = n_owned; c < cells.size(); ++c)
      values[c] = buffer.local_element(buffer_places[c]);
  }



  template class CellNeighbors<2>;
  template class CellNeighbors<3>;
} // namespace greville

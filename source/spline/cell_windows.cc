// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/cell_windows.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  CellWindows<dim>::reinit(const SplineSpace<dim> &space,
                           const bool              averages_values)
  {
    with_values               = averages_values;
    spline_space              = &space;
    const unsigned int n      = space.degree() + 3;
    n_in_window               = Utilities::fixed_power<dim>(n);
    const auto     &lattice   = space.lattice();
    const auto     &n_cells   = lattice.n_cells();
    const auto     &extents   = space.n_functions();
    const auto      not_there = std::uint64_t(-1);
    MultiIndex<dim> window;
    window.fill(n);

    std::vector<std::uint64_t> positions;
    positions.reserve(space.owned_cells().size() * n_in_window);
    for (const std::uint64_t position : space.owned_cells())
      {
        const auto cell = multi_index<dim>(position, n_cells);
        for (unsigned int a = 0; a < n_in_window; ++a)
          {
            auto function = multi_index<dim>(a, window);
            bool is_there = true;
            for (unsigned int d = 0; d < dim; ++d)
              {
                // The first function of the lower neighbour is one less than
                // the first function of the cell, which has the number of the
                // cell.
                function[d] +=
                  cell[d] + (lattice.is_periodic(d) ? extents[d] : 0);
                if (lattice.is_periodic(d))
                  function[d] = (function[d] - 1) % extents[d];
                else if (function[d] == 0 || function[d] > extents[d])
                  is_there = false;
                else
                  --function[d];
              }
            positions.push_back(is_there ? lexicographic<dim>(function, extents)
                                         : not_there);
          }
      }

    // Only functions that are not local in the space must be asked for.
    std::vector<std::uint64_t> others = positions;
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    if (!others.empty() && others.back() == not_there)
      others.pop_back();
    const auto                           numbers = space.global_numbers(others);
    const auto                          &owned   = space.locally_owned_dofs();
    IndexSet                             ghosts(space.n_dofs());
    std::vector<types::global_dof_index> sorted = numbers;
    std::sort(sorted.begin(), sorted.end());
    ghosts.add_indices(sorted.begin(), sorted.end());
    ghosts.subtract_set(owned);
    const auto partitioner =
      std::make_shared<const Utilities::MPI::Partitioner>(owned,
                                                          ghosts,
                                                          space.communicator());
    buffer_vector.reinit(partitioner);

    buffer_places.resize(positions.size());
    for (std::size_t k = 0; k < positions.size(); ++k)
      buffer_places[k] =
        positions[k] == not_there
          ? n_places() - 1
          : partitioner->global_to_local(
              numbers[std::lower_bound(
                        others.begin(), others.end(), positions[k]) -
                      others.begin()]);
    reaching.assign(space.owned_cells().size(), 0);
  }



  template <int dim>
  void
  CellWindows<dim>::update(const Extension<dim> &extension)
  {
    const unsigned int n_owned = spline_space->owned_functions().size();
    for (unsigned int f = 0; f < n_owned; ++f)
      buffer_vector.local_element(f) = extension[f] == Extension<dim>::stable ||
                                       extension[f] == Extension<dim>::extended;
    buffer_vector.update_ghost_values();
    const unsigned int none = n_places() - 1;
    for (unsigned int cell = 0; cell < reaching.size(); ++cell)
      reaching[cell] =
        std::all_of(functions(cell),
                    functions(cell) + n_in_window,
                    [&](const unsigned int f) {
                      return f == none || buffer_vector.local_element(f) == 1.;
                    });
    buffer_vector.zero_out_ghost_values();
  }



  template <int dim>
  void
  CellWindows<dim>::read(const VectorType  &vector,
                         double            *numbers,
                         const unsigned int stride) const
  {
    const std::size_t none = n_places() - 1;
    buffer_vector.copy_locally_owned_data_from(vector);
    buffer_vector.update_ghost_values();
    for (std::size_t f = 0; f < none; ++f)
      numbers[f * stride] = buffer_vector.local_element(f);
    numbers[none * stride] = 0.;
    buffer_vector.zero_out_ghost_values();
  }



  template <int dim>
  void
  CellWindows<dim>::read(const VectorField<dim> &field,
                         std::vector<double>    &buffer) const
  {
    buffer.resize(n_places() * dim);
    for (unsigned int d = 0; d < dim; ++d)
      read(field[d], buffer.data() + d, dim);
  }



  template <int dim>
  void
  CellWindows<dim>::add_to(VectorType        &vector,
                           const double      *numbers,
                           const unsigned int stride) const
  {
    const std::size_t none = n_places() - 1;
    for (std::size_t f = 0; f < none; ++f)
      buffer_vector.local_element(f) = numbers[f * stride];
    buffer_vector.compress(VectorOperation::add);
    for (unsigned int f = 0; f < buffer_vector.locally_owned_size(); ++f)
      vector.local_element(f) += buffer_vector.local_element(f);
    buffer_vector.zero_out_ghost_values();
  }



  template <int dim>
  void
  CellWindows<dim>::add_to(VectorField<dim>          &field,
                           const std::vector<double> &buffer) const
  {
    AssertThrow(buffer.size() == n_places() * dim,
                ExcDimensionMismatch(buffer.size(), n_places() * dim));
    for (unsigned int d = 0; d < dim; ++d)
      add_to(field[d], buffer.data() + d, dim);
  }



  GREVILLE_INSTANTIATE_CLASS(CellWindows);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/base/with_width.h>
#include <greville/mass/extended_unknowns.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  const std::array<bool, dim> &
  ExtendedUnknowns<dim>::has_constrained() const
  {
    return component_has_constrained;
  }



  template <int dim>
  unsigned int
  ExtendedUnknowns<dim>::n_owned_unknowns() const
  {
    return n_owned;
  }



  template <int dim>
  MPI_Comm
  ExtendedUnknowns<dim>::communicator() const
  {
    return stencil->space().communicator();
  }



  template <int dim>
  const std::shared_ptr<const InterleavedLayout> &
  ExtendedUnknowns<dim>::unknown_layout() const
  {
    return layout;
  }



  template <int dim>
  const std::vector<unsigned int> &
  ExtendedUnknowns<dim>::unknown_places() const
  {
    return unknowns;
  }



  template <int dim>
  const std::vector<unsigned int> &
  ExtendedUnknowns<dim>::unknown_functions() const
  {
    return owned_unknown_functions;
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::reinit(const StencilPlaces<dim> &places)
  {
    stencil        = &places;
    place_x        = ZeroedArray<double>(places.size() * max_width);
    place_y        = ZeroedArray<double>(places.size() * max_width);
    single_x       = ZeroedArray<float>(places.size() * max_width);
    signed_numbers = ZeroedArray<int>(places.size());
    is_numbered    = false;
    layout         = nullptr;
    unknowns.clear();
    owned_unknown_functions.clear();
    extended.clear();
    constrained_functions.assign(n_owned_functions() +
                                   places.space().ghost_functions().size(),
                                 0);
  }



  template <int dim>
  bool
  ExtendedUnknowns<dim>::update(const Extension<dim> &e, const bool changed)
  {
    extension = &e;
    if (!changed && is_numbered)
      return false;
    number_unknowns();
    is_numbered = true;
    return true;
  }



  namespace
  {
    /// Collective. Ask the owners for the numbers of unknowns at given
    /// positions. Return pairs of number and position, ascending. The unknowns
    /// of this process are @p functions, numbered from @p first_unknown on.
    template <int dim>
    std::vector<std::pair<types::global_dof_index, std::uint64_t>>
    find_unknowns(const SplineSpace<dim>           &space,
                  const std::vector<unsigned int>  &functions,
                  const types::global_dof_index     first_unknown,
                  const std::vector<std::uint64_t> &positions)
    {
      const auto dofs   = space.global_numbers(positions);
      auto       sorted = dofs;
      std::sort(sorted.begin(), sorted.end());
      IndexSet ghosts(space.n_dofs());
      ghosts.add_indices(sorted.begin(), sorted.end());
      VectorType numbers_of(space.locally_owned_dofs(),
                            ghosts,
                            space.communicator());
      for (unsigned int u = 0; u < functions.size(); ++u)
        numbers_of.local_element(functions[u]) = first_unknown + u;
      numbers_of.update_ghost_values();

      std::vector<std::pair<types::global_dof_index, std::uint64_t>> result;
      for (unsigned int k = 0; k < positions.size(); ++k)
        result.emplace_back(numbers_of(dofs[k]), positions[k]);
      std::sort(result.begin(), result.end());
      return result;
    }
  } // namespace



  template <int dim>
  void
  ExtendedUnknowns<dim>::number_unknowns()
  {
    for (const auto *old : {&unknowns, &extended})
      for (const unsigned int place : *old)
        if (place != numbers::invalid_unsigned_int)
          signed_numbers[place] = 0;
    const bool owned_changed = choose_unknowns();

    // The rows of E for extended functions have positions instead of numbers.
    const auto &rows   = extension->rows();
    extended_functions = extension->extended_functions();
    extended_begin     = rows.begin;
    extended.clear();
    for (const unsigned int f : extended_functions)
      extended.push_back(stencil->place(f));

    const auto ghost_of = number_ghost_unknowns(rows.positions, owned_changed);
    for (unsigned int u = 0; u < unknowns.size(); ++u)
      if (unknowns[u] != numbers::invalid_unsigned_int)
        signed_numbers[unknowns[u]] = 1 + int(u);
    for (unsigned int k = 0; k < extended.size(); ++k)
      signed_numbers[extended[k]] = -1 - int(k);

    extended_entries.clear();
    const auto &owned = stencil->space().owned_functions();
    auto        place = owned.begin();
    for (std::size_t e = 0; e < rows.positions.size(); ++e)
      {
        // Most positions follow the one before.
        const std::uint64_t position = rows.positions[e];
        if (place != owned.end() && *place != position)
          ++place;
        if (place == owned.end() || *place != position)
          place = std::lower_bound(owned.begin(), owned.end(), position);
        const bool is_owned = place != owned.end() && *place == position;
        const unsigned int unknown =
          is_owned ? signed_numbers[stencil->place(place - owned.begin())] - 1
                   : ghost_of.at(position);
        extended_entries.push_back({unknown, rows.weights[e]});
      }

    add_rows_of_images();
  }



  template <int dim>
  bool
  ExtendedUnknowns<dim>::choose_unknowns()
  {
    using Kind                          = Extension<dim>;
    const SplineSpace<dim> &space       = stencil->space();
    const unsigned int      n_functions = space.owned_functions().size();
    const unsigned int n_all = n_functions + space.ghost_functions().size();
    const auto         old_functions = std::move(owned_unknown_functions);
    unknowns.clear();
    owned_unknown_functions.clear();
    lumped.clear();
    for (unsigned int f = 0; f < n_functions; ++f)
      if ((*extension)[f] == Kind::stable || (*extension)[f] == Kind::lumped)
        {
          unknowns.push_back(stencil->place(f));
          owned_unknown_functions.push_back(f);
        }
    n_owned = unknowns.size();
    for (unsigned int f = 0; f < n_all; ++f)
      if ((*extension)[f] == Kind::lumped)
        lumped.push_back(stencil->place(f));
    for_each_active_image([&](const unsigned int f, const std::size_t place) {
      if ((*extension)[f] == Kind::lumped)
        lumped.push_back(place);
    });
    return owned_unknown_functions != old_functions;
  }



  template <int dim>
  std::map<std::uint64_t, unsigned int>
  ExtendedUnknowns<dim>::number_ghost_unknowns(
    const std::vector<std::uint64_t> &positions_in_E, const bool owned_changed)
  {
    using Kind                          = Extension<dim>;
    const SplineSpace<dim> &space       = stencil->space();
    const unsigned int      n_functions = space.owned_functions().size();
    const unsigned int n_all = n_functions + space.ghost_functions().size();
    const MPI_Comm     comm  = communicator();
    std::map<std::uint64_t, unsigned int> ghost_of;
    std::vector<std::uint64_t>            positions;
    const bool is_parallel = Utilities::MPI::n_mpi_processes(comm) > 1;
    if (is_parallel)
      {
        const auto &owned = space.owned_functions();
        for (unsigned int f = n_functions; f < n_all; ++f)
          if ((*extension)[f] == Kind::stable ||
              (*extension)[f] == Kind::lumped)
            ghost_of[space.function_position(f)] = f;
        for (const std::uint64_t position : positions_in_E)
          if (!std::binary_search(owned.begin(), owned.end(), position))
            ghost_of.emplace(position, numbers::invalid_unsigned_int);
        for (const auto &entry : ghost_of)
          positions.push_back(entry.first);
      }
    const bool changes = !layout || owned_changed ||
                         ghost_positions.size() != positions.size() ||
                         std::any_of(ghost_positions.begin(),
                                     ghost_positions.end(),
                                     [&](const std::uint64_t position) {
                                       return ghost_of.count(position) == 0;
                                     });
    if (Utilities::MPI::logical_or(changes, comm))
      {
        const types::global_dof_index first_unknown =
          is_parallel ? sum_before(n_owned, comm) : 0;
        std::vector<types::global_dof_index> ghost_unknowns;
        ghost_positions.clear();
        if (is_parallel)
          for (const auto &[number, position] : find_unknowns(
                 space, owned_unknown_functions, first_unknown, positions))
            {
              ghost_unknowns.push_back(number);
              ghost_positions.push_back(position);
            }
        layout = std::make_shared<const InterleavedLayout>(first_unknown,
                                                           n_owned,
                                                           ghost_unknowns,
                                                           comm);
      }
    for (const std::uint64_t position : ghost_positions)
      {
        unsigned int      &found = ghost_of.at(position);
        const unsigned int f     = found;
        found                    = unknowns.size();
        unknowns.push_back(f == numbers::invalid_unsigned_int
                             ? numbers::invalid_unsigned_int
                             : stencil->place(f));
      }
    return ghost_of;
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::add_rows_of_images()
  {
    for_each_active_image([&](const unsigned int f, const std::size_t place) {
      const int signed_number = signed_numbers[stencil->place(f)];
      if (signed_number > 0)
        extended_entries.push_back({unsigned(signed_number - 1), 1.});
      else if (signed_number < 0)
        for (std::size_t e = extended_begin[-signed_number - 1];
             e < extended_begin[-signed_number];
             ++e)
          {
            const Entry entry = extended_entries[e];
            extended_entries.push_back(entry);
          }
      extended.push_back(place);
      extended_begin.push_back(extended_entries.size());
      signed_numbers[place] = -int(extended.size());
    });
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::constrain(
    const std::vector<unsigned char> &constrained)
  {
    constrained_functions = constrained;
    constrained_places.clear();
    for (unsigned int f = 0; f < constrained.size(); ++f)
      if (constrained[f] != 0 && (*extension)[f] != Extension<dim>::inactive)
        constrained_places.emplace_back(stencil->place(f), constrained[f]);

    for_each_active_image([&](const unsigned int f, const std::size_t place) {
      if (constrained[f] != 0)
        constrained_places.emplace_back(place, constrained[f]);
    });

    constexpr unsigned int    all = (1u << dim) - 1;
    std::vector<unsigned int> found(2 * dim);
    for (const auto &entry : constrained_places)
      for (unsigned int c = 0; c < dim; ++c)
        if ((entry.second >> c) & 1)
          {
            found[c] = 1;
            found[dim + c] |= entry.second != all;
          }
    Utilities::MPI::max(found, communicator(), found);
    for (unsigned int c = 0; c < dim; ++c)
      {
        component_has_constrained[c]       = found[c] != 0;
        component_is_partly_constrained[c] = found[dim + c] != 0;
      }
  }



  template <int dim>
  std::vector<unsigned char>
  ExtendedUnknowns<dim>::constrained_unknowns() const
  {
    std::vector<unsigned char> result;
    result.reserve(n_owned);
    for (const unsigned int f : owned_unknown_functions)
      result.push_back(constrained_functions[f]);
    return result;
  }



  template <int dim>
  std::vector<std::array<int, 3>>
  ExtendedUnknowns<dim>::unknown_positions() const
  {
    const SplineSpace<dim>         &space = stencil->space();
    std::vector<std::array<int, 3>> result(n_owned);
    for (unsigned int u = 0; u < n_owned; ++u)
      {
        const auto i =
          multi_index<dim>(space.owned_functions()[owned_unknown_functions[u]],
                           space.n_functions());
        result[u] = {};
        for (unsigned int d = 0; d < dim; ++d)
          result[u][d] = i[d];
      }
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(ExtendedUnknowns);
} // namespace greville

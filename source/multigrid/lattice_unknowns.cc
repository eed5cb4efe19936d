// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/base/with_width.h>
#include <greville/multigrid/lattice_unknowns.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The states of a component of a function: no process needs it, a process
    // needs it, it interpolates a constrained component.
    constexpr double is_needed = 1., is_constraining = 2.;



    /// Values of the listed functions, combined over the processes that list
    /// the same functions.
    class ListedValues
    {
    public:
      using Keys = std::vector<types::global_dof_index>;

      /// Collective. The @p keys, below @p n_keys, are kept by reference.
      ListedValues(const std::uint64_t n_keys,
                   const Keys         &keys,
                   const MPI_Comm      comm)
        : keys(keys)
      {
        const std::uint64_t me = Utilities::MPI::this_mpi_process(comm);
        const std::uint64_t n  = Utilities::MPI::n_mpi_processes(comm);
        IndexSet            mine(n_keys), others(n_keys);
        mine.add_range(n_keys * me / n, n_keys * (me + 1) / n);
        others.add_indices(keys.begin(), keys.end());
        list.reinit(mine, others, comm);
      }

      /// Collective. Set all entries to the initial value, combine the entries
      /// that set(k, entry) changes on all processes, and return the results.
      template <typename Set>
      std::vector<double>
      combine(const double                  initial,
              const VectorOperation::values operation,
              const Set                    &set)
      {
        list.zero_out_ghost_values();
        for (unsigned int k = 0;
             k < list.locally_owned_size() +
                   list.get_partitioner()->n_ghost_indices();
             ++k)
          list.local_element(k) = initial;
        for (std::size_t k = 0; k < keys.size(); ++k)
          set(k, list(keys[k]));
        list.compress(operation);
        list.update_ghost_values();
        std::vector<double> result;
        for (const auto k : keys)
          result.push_back(list(k));
        return result;
      }

    private:
      const Keys                                &keys;
      LinearAlgebra::distributed::Vector<double> list;
    };
  } // namespace



  template <int dim>
  LatticeUnknowns<dim>::LatticeUnknowns(const LatticeLevel<dim> &fine,
                                        const bool               coarsen)
    : components(fine.n_components())
  {
    const Lattice fine_knots = fine.lattice();
    for (unsigned int d = 0; d < 3; ++d)
      knots[d] = coarsen ? fine_knots[d].coarser() : fine_knots[d];
    for (unsigned int d = 0; d < 3; ++d)
      {
        const int n = fine_knots[d].n_functions();
        for (int i = -margin(); i < n + margin(); ++i)
          insertions[d].push_back(fine_knots[d].is_periodic() ||
                                      (i >= 0 && i < n)
                                    ? fine_knots[d].insertion(i, knots[d])
                                    : NestedKnots::Row{0, {}});
      }
    number_unknowns(fine);
    make_places();
    make_transfer(fine);
  }



  template <int dim>
  typename LatticeUnknowns<dim>::Wanted
  LatticeUnknowns<dim>::find_wanted(const LatticeLevel<dim> &fine) const
  {
    const auto fine_positions = fine.unknown_positions();
    const auto fine_bits      = fine.constrained_unknowns();
    // Positions of unknowns; on several processes, also positions in rows.
    std::vector<std::pair<Position, unsigned char>> all;
    for (unsigned int u = 0; u < fine_positions.size(); ++u)
      all.emplace_back(fine_positions[u],
                       ~fine_bits[u] & ((1u << components) - 1));
    if (Utilities::MPI::n_mpi_processes(fine.layout().communicator()) > 1)
      {
        fine.for_each_row(
          [&](const Position &f, const float *) { all.emplace_back(f, 0); });
        fine.for_each_extended([&](const Position &, const auto &terms) {
          for (const auto &term : terms)
            all.emplace_back(term.first, 0);
        });
      }
    Wanted result;
    {
      // The corners of the coarse functions.
      std::vector<std::pair<Position, int>> corners;
      corners.reserve(2 * all.size());
      for (const auto &entry : all)
        {
          Position low, high;
          for (unsigned int d = 0; d < 3; ++d)
            {
              const NestedKnots::Row &r = insertion(d, entry.first[d]);
              low[d]                    = knots[d].is_periodic() ? 0 : r.first;
              high[d]                   = knots[d].is_periodic()
                                            ? knots[d].n_functions() - 1
                                            : r.first + int(r.weights.size()) - 1;
            }
          corners.emplace_back(low, 0);
          corners.emplace_back(high, 0);
        }
      result.boxes.fit(knots[0], corners, {{0, 0, 0}});
    }
    result.needed.assign(result.boxes.size(), 0);
    result.is_listed.assign(result.boxes.size(), 0);
    for (unsigned int k = 0; k < all.size(); ++k)
      if (all[k].second != 0 || k >= fine_positions.size())
        for_each_coarse(all[k].first, [&](const Position &i, const float) {
          const std::size_t place = result.boxes.place(wrapped(i));
          result.needed[place] |= all[k].second;
          result.is_listed[place] = 1;
        });
    return result;
  }



  template <int dim>
  void
  LatticeUnknowns<dim>::number_unknowns(const LatticeLevel<dim> &fine)
  {
    const MPI_Comm      comm        = fine.layout().communicator();
    const unsigned int  me          = Utilities::MPI::this_mpi_process(comm);
    const std::uint64_t n_processes = Utilities::MPI::n_mpi_processes(comm);

    // The listed functions: their keys, in ascending order, and the components
    // that are needed.
    const Wanted       wanted = find_wanted(fine);
    const LatticeBoxes all    = wanted.boxes.of_all_processes(knots[0], comm);
    checked_index<types::global_dof_index>(all.size(), "functions of a level");
    std::vector<types::global_dof_index> keys;
    std::vector<unsigned char>           needed;
    std::vector<Position>                listed;
    for (std::size_t place = 0; place < wanted.is_listed.size(); ++place)
      if (wanted.is_listed[place])
        {
          listed.push_back(wanted.boxes.position(place));
          keys.push_back(all.place(listed.back()));
          needed.push_back(wanted.needed[place]);
        }
    ListedValues values(std::max<std::size_t>(all.size(), 1), keys, comm);

    // The first process that needs a function owns it.
    const auto          owners  = values.combine(n_processes,
                                       VectorOperation::min,
                                       [&](const std::size_t k, double &entry) {
                                         if (needed[k] != 0)
                                           entry = me;
                                       });
    const std::uint64_t n_owned = std::count(owners.begin(), owners.end(), me);
    const std::uint64_t first   = sum_before(n_owned, comm);
    std::uint64_t       next    = first;
    const auto          numbers =
      values.combine(0.,
                     VectorOperation::add,
                     [&](const std::size_t k, double &entry) {
                       if (owners[k] == me)
                         entry = next++;
                     });
    std::vector<std::pair<types::global_dof_index, std::size_t>> ghosts;
    std::vector<std::size_t> of_unknowns; // listed functions
    for (std::size_t k = 0; k < keys.size(); ++k)
      if (owners[k] == me)
        of_unknowns.push_back(k);
      else if (owners[k] < n_processes)
        ghosts.emplace_back(types::global_dof_index(numbers[k]), k);
    std::sort(ghosts.begin(), ghosts.end());
    std::vector<types::global_dof_index> ghost_numbers;
    for (const auto &[number, k] : ghosts)
      {
        ghost_numbers.push_back(number);
        of_unknowns.push_back(k);
      }
    for (const std::size_t k : of_unknowns)
      local_positions.push_back(listed[k]);
    unknowns = std::make_shared<const InterleavedLayout>(first,
                                                         n_owned,
                                                         ghost_numbers,
                                                         comm);

    constrained_components.assign(of_unknowns.size(), 0);
    for (unsigned int c = 0; c < components; ++c)
      {
        const auto states = states_of_component(c, wanted, fine);
        const auto of_all =
          values.combine(0.,
                         VectorOperation::max,
                         [&](const std::size_t k, double &entry) {
                           entry = states[wanted.boxes.place(listed[k])];
                         });
        for (unsigned int u = 0; u < of_unknowns.size(); ++u)
          if (of_all[of_unknowns[u]] != is_needed)
            constrained_components[u] |= 1u << c;
      }
  }



  template <int dim>
  std::vector<double>
  LatticeUnknowns<dim>::states_of_component(const unsigned int       c,
                                            const Wanted            &wanted,
                                            const LatticeLevel<dim> &fine) const
  {
    std::vector<double> states(wanted.boxes.size(), 0.);
    for (std::size_t place = 0; place < states.size(); ++place)
      if ((wanted.needed[place] >> c) & 1)
        states[place] = is_needed;
    for (const auto &[f, bits] : fine.constrained_functions())
      if ((bits >> c) & 1)
        for_each_coarse(f, [&](const Position &i, const float) {
          const std::size_t place = wanted.boxes.place(wrapped(i));
          if (place < states.size())
            states[place] = is_constraining;
        });
    return states;
  }



  template <int dim>
  void
  LatticeUnknowns<dim>::make_places()
  {
    const int      p = knots[0].degree();
    const Position reach{{p, p, dim == 3 ? p : 0}};
    std::vector<std::pair<Position, unsigned int>> all;
    for (unsigned int u = 0; u < local_positions.size(); ++u)
      all.emplace_back(local_positions[u], u);
    add_periodic_images(knots, reach, all);
    boxes.fit(knots[0], all, reach);
    checked_index<unsigned int>(boxes.size(), "places of a level");
    unknown_at.assign(boxes.size(), -1);
    for (unsigned int k = 0; k < all.size(); ++k)
      {
        const unsigned int at = boxes.place(all[k].first);
        unknown_at[at]        = all[k].second;
        if (k < local_positions.size())
          {
            unknown_places.push_back(at);
            unknown_levels.push_back(level(all[k].first));
          }
        else
          image_places.emplace_back(at, all[k].second);
      }
    distances.resize(boxes.n_levels());
    for (unsigned int l = 0; l < boxes.n_levels(); ++l)
      for (int z = -reach[2]; z <= reach[2]; ++z)
        for (int y = -p; y <= p; ++y)
          distances[l].push_back((std::ptrdiff_t(z) * boxes[l].extents[1] + y) *
                                 boxes[l].extents[0]);
  }



  template <int dim>
  void
  LatticeUnknowns<dim>::make_transfer(const LatticeLevel<dim> &fine)
  {
    for (const Position &f : fine.unknown_positions())
      {
        for_each_coarse(f, [&](const Position &i, const float weight) {
          const int u = find(wrapped(i));
          if (u >= 0)
            transfer.push_back({unsigned(u), weight});
        });
        transfer_begin.push_back(transfer.size());
      }
  }



  template <int dim>
  void
  LatticeUnknowns<dim>::prolongate_and_add(SingleVector &fine,
                                           SingleVector &coarse) const
  {
    coarse.update_ghost_values();
    with_one_of<1, dim>(components, [&](const auto width) {
      constexpr int nc   = decltype(width)::value;
      const float  *from = coarse.begin();
      float        *to   = fine.begin();
      for (std::size_t f = 0; f + 1 < transfer_begin.size(); ++f, to += nc)
        for (std::size_t e = transfer_begin[f]; e < transfer_begin[f + 1]; ++e)
          for (int c = 0; c < nc; ++c)
            to[c] += transfer[e].weight * from[transfer[e].unknown * nc + c];
    });
    coarse.zero_out_ghost_values();
  }



  template <int dim>
  void LatticeUnknowns<dim>::restrict(SingleVector       &coarse,
                                      const SingleVector &fine) const
  {
    coarse = 0.f;
    with_one_of<1, dim>(components, [&](const auto width) {
      constexpr int nc   = decltype(width)::value;
      const float  *from = fine.begin();
      float        *to   = coarse.begin();
      for (std::size_t f = 0; f + 1 < transfer_begin.size(); ++f, from += nc)
        for (std::size_t e = transfer_begin[f]; e < transfer_begin[f + 1]; ++e)
          for (int c = 0; c < nc; ++c)
            to[transfer[e].unknown * nc + c] += transfer[e].weight * from[c];
    });
    coarse.compress(VectorOperation::add);
    for (unsigned int u = 0; u < unknowns->n_owned(); ++u)
      if (constrained_components[u] != 0)
        for (unsigned int c = 0; c < components; ++c)
          if (is_constrained(u, c))
            coarse.local_element(u * components + c) = 0.f;
  }



  GREVILLE_INSTANTIATE_CLASS(LatticeUnknowns);
} // namespace greville

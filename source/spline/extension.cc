// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/spline/extension.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The weight of a cell in the sum over a function's support: with_host for
    // host cells, 1 for other cells with points, 0 beyond the body.
    constexpr double with_host = 1024.;

    // The weight of a host is its squared distance, relative to the distance of
    // the nearest host, to this power; below the limit it is not used.
    template <int dim>
    constexpr double distance_power = dim == 2 ? -6. : -50.;
    constexpr double smallest_share = 0.01;
  } // namespace



  template <int dim>
  void
  Extension<dim>::reinit(const SplineSpace<dim> &space,
                         const CellFilling<dim> &filling,
                         const bool              constant)
  {
    is_constant = constant;
    if (spline_space != &space)
      space.initialize_vector(support_weights);
    spline_space = &space;
    cell_filling = &filling;
    const unsigned int n_local =
      space.owned_functions().size() + space.ghost_functions().size();

    support_weights.zero_out_ghost_values();
    support_weights = 0.;
    for (const unsigned int cell : filling.filled_cells())
      {
        const double add = filling.is_host(cell)        ? with_host
                           : filling.holds_points(cell) ? 1.
                                                        : 0.;
        for (const unsigned int f : space.cell_functions(cell))
          support_weights.local_element(f) += add;
      }
    if (Utilities::MPI::n_mpi_processes(space.communicator()) > 1)
      {
        support_weights.compress(VectorOperation::add);
        support_weights.update_ghost_values();
      }

    find_hosts();
    classes.resize(n_local);
    for (unsigned int f = 0; f < n_local; ++f)
      {
        const double n = support_weights.local_element(f);
        classes[f]     = n == 0. ? inactive : n >= with_host ? stable : lumped;
      }
    for (const unsigned int f : extended_numbers)
      classes[f] = extended;
  }



  template <int dim>
  void
  Extension<dim>::find_hosts()
  {
    const SplineSpace<dim> &space = *spline_space;

    // Hosts of the owned cells of functions without a host among their cells.
    using HostOfFunction = std::pair<unsigned int, std::uint64_t>;
    std::vector<HostOfFunction> found;
    for (const auto &entry : cell_filling->hosts())
      for (const unsigned int f : space.cell_functions(entry.first))
        if (support_weights.local_element(f) < with_host &&
            !cell_filling->is_at_contact_wall(
              multi_index<dim>(space.function_position(f), space.n_functions()),
              space.n_functions()))
          found.emplace_back(f, entry.second);
    const auto sort = [&]() {
      std::sort(found.begin(), found.end());
      found.erase(std::unique(found.begin(), found.end()), found.end());
    };
    sort();

    if (Utilities::MPI::n_mpi_processes(space.communicator()) > 1)
      {
        // The owners of functions collect their hosts and send them to all
        // processes that know the function.
        using Message = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
        const auto &partitioner = *space.partitioner();
        const auto  n_owned     = space.owned_functions().size();
        const auto  add = [&](const std::map<unsigned int, Message> &in) {
          for (const auto &message : in)
            for (const auto &entry : message.second)
              found.emplace_back(partitioner.global_to_local(entry.first),
                                 entry.second);
          sort();
        };
        const auto for_each_host = [&](const unsigned int f,
                                       const auto        &action) {
          for (auto entry = std::lower_bound(found.begin(),
                                             found.end(),
                                             HostOfFunction(f, 0));
               entry != found.end() && entry->first == f;
               ++entry)
            action(*entry);
        };

        std::map<unsigned int, Message> to_owners;
        unsigned int                    f = n_owned;
        for (const auto &target : partitioner.ghost_targets())
          for (unsigned int k = 0; k < target.second; ++k, ++f)
            for_each_host(f, [&](const HostOfFunction &entry) {
              to_owners[target.first].emplace_back(
                partitioner.local_to_global(f), entry.second);
            });
        add(exchange_lists(space.communicator(), to_owners));

        std::map<unsigned int, Message> to_others;
        auto range = partitioner.import_indices().begin();
        for (const auto &target : partitioner.import_targets())
          for (unsigned int n = 0; n < target.second; ++range)
            for (f = range->first; f < range->second; ++f, ++n)
              for_each_host(f, [&](const HostOfFunction &entry) {
                to_others[target.first].emplace_back(
                  partitioner.local_to_global(f), entry.second);
              });
        add(exchange_lists(space.communicator(), to_others));
      }

    extended_numbers.clear();
    hosts.clear();
    hosts_begin.clear();
    for (const HostOfFunction &entry : found)
      {
        if (extended_numbers.empty() || extended_numbers.back() != entry.first)
          {
            extended_numbers.push_back(entry.first);
            hosts_begin.push_back(hosts.size());
          }
        hosts.push_back(entry.second);
      }
    hosts_begin.push_back(hosts.size());
  }



  template <int dim>
  void
  Extension<dim>::row(const unsigned int          function,
                      std::vector<std::uint64_t> &positions,
                      std::vector<double>        &weights) const
  {
    const SplineSpace<dim> &space   = *spline_space;
    const unsigned int      p       = space.degree();
    const auto             &extents = space.n_functions();
    const auto              place   = std::lower_bound(extended_numbers.begin(),
                                        extended_numbers.end(),
                                        function);
    AssertThrow(place != extended_numbers.end() && *place == function,
                ExcMessage("The function is not extended."));
    const auto i = multi_index<dim>(space.function_position(function), extents);
    MultiIndex<dim> local_extents;
    local_extents.fill(p + 1);
    const unsigned int n = space.n_dofs_per_cell() / space.n_components();

    const std::size_t begin = hosts_begin[place - extended_numbers.begin()],
                      end   = hosts_begin[place - extended_numbers.begin() + 1];

    // Squared distances of centers, in half cells. In a periodic grid, the
    // image of the function nearest to the host counts.
    const auto &lattice = space.lattice();
    const auto  periods = [&](const unsigned int host, const int d) {
      if (!lattice.is_periodic(d))
        return 0;
      const int n = lattice.n_cells()[d];
      return int(std::ceil((2. * host - (2. * i[d] - p)) / (2. * n) - 0.5));
    };
    std::vector<double> shares(end - begin);
    for (std::size_t h = begin; h < end; ++h)
      {
        const auto host = multi_index<dim>(hosts[h], lattice.n_cells());
        for (unsigned int d = 0; d < dim; ++d)
          shares[h - begin] +=
            std::pow(2. * host[d] - (2. * i[d] - p) -
                       2. * lattice.n_cells()[d] * periods(host[d], d),
                     2);
      }
    const double nearest    = *std::min_element(shares.begin(), shares.end());
    double       all_shares = 0.;
    for (double &share : shares)
      {
        share = std::pow(share / nearest, distance_power<dim>);
        if (share < smallest_share)
          share = 0.;
        all_shares += share;
      }

    std::vector<std::pair<std::uint64_t, double>> entries;
    for (std::size_t h = begin; h < end; ++h)
      {
        if (shares[h - begin] == 0.)
          continue;
        const auto host = multi_index<dim>(hosts[h], lattice.n_cells());
        double     factors[dim][SplineSpace<dim>::max_degree + 1];
        for (unsigned int d = 0; d < dim; ++d)
          {
            if (is_constant)
              {
                const int nearest =
                  int(i[d]) - int(host[d]) +
                  int(lattice.n_cells()[d]) * periods(host[d], d);
                for (int k = 0; k <= int(p); ++k)
                  factors[d][k] = k == std::clamp(nearest, 0, int(p));
                continue;
              }
            const double move =
              (lattice.upper()[d] - lattice.lower()[d]) * periods(host[d], d);
            double inner_knots[SplineSpace<dim>::max_degree];
            for (unsigned int k = 0; k < p; ++k)
              inner_knots[k] = space.knots(d).knots()[i[d] + 1 + k] + move;
            space.knots(d).blossom(host[d],
                                   ArrayView<const double>(inner_knots, p),
                                   ArrayView<double>(factors[d], p + 1));
          }
        for (unsigned int k = 0; k < n; ++k)
          {
            auto   a      = multi_index<dim>(k, local_extents);
            double weight = shares[h - begin] / all_shares;
            for (unsigned int d = 0; d < dim; ++d)
              {
                weight *= factors[d][a[d]];
                a[d] += host[d];
                if (a[d] >= extents[d]) // periodic
                  a[d] -= extents[d];
              }
            if (weight != 0.)
              entries.emplace_back(lexicographic<dim>(a, extents), weight);
          }
      }
    std::sort(entries.begin(), entries.end());
    positions.clear();
    weights.clear();
    for (const auto &entry : entries)
      if (!positions.empty() && positions.back() == entry.first)
        weights.back() += entry.second;
      else
        {
          positions.push_back(entry.first);
          weights.push_back(entry.second);
        }
  }



  template <int dim>
  typename Extension<dim>::Counts
  Extension<dim>::counts() const
  {
    Counts                     result;
    std::vector<std::uint64_t> n(4);
    for (unsigned int f = 0; f < spline_space->owned_functions().size(); ++f)
      ++n[classes[f]];
    Utilities::MPI::sum(n, spline_space->communicator(), n);
    result.stable   = n[stable];
    result.extended = n[extended];
    result.lumped   = n[lumped];
    return result;
  }



  template class Extension<2>;
  template class Extension<3>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/spline/extension.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The weight of a cell in the sum over a function's support: with_host for
    // host cells, with_full for other well-filled cells, 1 for cut cells, 0
    // beyond the body. Smaller weights do not add up to the next larger one.
    constexpr double with_host = 1048576., with_full = 1024.;

    // The weight of a host is its squared distance over the squared distance of
    // the nearest host, to this power. Hosts with a smaller share are ignored.
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
    const ExtendedFunctions old =
      spline_space == &space && is_constant == constant ? std::move(functions)
                                                        : ExtendedFunctions();
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
        const double add = filling.is_host(cell)          ? with_host
                           : filling.is_well_filled(cell) ? with_full
                           : filling.holds_points(cell)   ? 1.
                                                          : 0.;
        for (const unsigned int f : space.cell_functions(cell))
          support_weights.local_element(f) += add;
      }
    if (Utilities::MPI::n_mpi_processes(space.communicator()) > 1)
      {
        support_weights.compress(VectorOperation::add);
        support_weights.update_ghost_values();
      }

    const bool has_levels = space.lattice().hierarchy();
    if (has_levels)
      {
        Require(!constant, "Constant extensions need a grid without levels.");
        levels.reinit(space, [&](const unsigned int f) {
          return support_weights.local_element(f) >= with_full;
        });
      }
    find_hosts();
    classes.resize(n_local);
    for (unsigned int f = 0; f < n_local; ++f)
      classes[f] = support_weights.local_element(f) == 0. ? inactive
                   : is_stable(f)                         ? stable
                                                          : lumped;
    for (const unsigned int f : functions.numbers)
      classes[f] = extended;
    if (has_levels)
      make_rows_of_levels();
    else
      make_rows(old);
  }



  template <int dim>
  void
  Extension<dim>::sort(std::vector<HostOfFunction> &found) const
  {
    // Sort by functions first, which have few hosts each.
    std::vector<std::size_t> end(spline_space->owned_functions().size() +
                                   spline_space->ghost_functions().size() + 1,
                                 0);
    for (const HostOfFunction &entry : found)
      ++end[entry.first + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<HostOfFunction> sorted(found.size());
    for (const HostOfFunction &entry : found)
      sorted[end[entry.first]++] = entry;
    std::size_t begin = 0;
    for (unsigned int f = 0; f + 1 < end.size(); begin = end[f++])
      std::sort(sorted.begin() + begin, sorted.begin() + end[f]);
    found.assign(sorted.begin(), std::unique(sorted.begin(), sorted.end()));
  }



  template <int dim>
  bool
  Extension<dim>::is_stable(const unsigned int f) const
  {
    const double n = support_weights.local_element(f);
    return n >= with_host || (n >= with_full && levels.is_at_refined_cells(f));
  }



  template <int dim>
  void
  Extension<dim>::find_hosts()
  {
    const SplineSpace<dim> &space = *spline_space;

    // Hosts of the owned cells of functions without a host among their cells.
    std::vector<HostOfFunction> found;
    const auto                  is_at_contact_wall = [&](const unsigned int f) {
      for (unsigned int side = 0; side < 2 * dim; ++side)
        if (cell_filling->is_contact_wall(side) && space.on_side(f, side))
          return true;
      return false;
    };
    const bool has_levels = space.lattice().hierarchy();
    for (const auto &entry : cell_filling->hosts())
      for (const unsigned int f : space.cell_functions(entry.first))
        if (!is_stable(f) && !is_at_contact_wall(f) &&
            !(has_levels && levels.is_tied(f)))
          found.emplace_back(f, entry.second);
    sort(found);

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
          sort(found);
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

    functions = ExtendedFunctions();
    for (const HostOfFunction &entry : found)
      {
        if (functions.numbers.empty() ||
            functions.numbers.back() != entry.first)
          {
            functions.numbers.push_back(entry.first);
            functions.hosts_begin.push_back(functions.hosts.size());
          }
        functions.hosts.push_back(entry.second);
      }
    functions.hosts_begin.push_back(functions.hosts.size());
  }



  template <int dim>
  void
  Extension<dim>::make_rows(const ExtendedFunctions &old)
  {
    Rows        &rows = functions.rows;
    unsigned int k    = 0;
    for (unsigned int i = 0; i < functions.numbers.size(); ++i)
      {
        while (k < old.numbers.size() && old.numbers[k] < functions.numbers[i])
          ++k;
        if (k < old.numbers.size() && old.numbers[k] == functions.numbers[i] &&
            std::equal(functions.hosts.begin() + functions.hosts_begin[i],
                       functions.hosts.begin() + functions.hosts_begin[i + 1],
                       old.hosts.begin() + old.hosts_begin[k],
                       old.hosts.begin() + old.hosts_begin[k + 1]))
          {
            const std::size_t begin = old.rows.begin[k],
                              end   = old.rows.begin[k + 1];
            rows.positions.insert(rows.positions.end(),
                                  old.rows.positions.begin() + begin,
                                  old.rows.positions.begin() + end);
            rows.weights.insert(rows.weights.end(),
                                old.rows.weights.begin() + begin,
                                old.rows.weights.begin() + end);
          }
        else
          append(row_from_hosts(i));
        rows.begin.push_back(rows.positions.size());
      }
  }



  template <int dim>
  void
  Extension<dim>::make_rows_of_levels()
  {
    std::vector<Row> rows;
    for (unsigned int k = 0; k < functions.numbers.size(); ++k)
      rows.push_back(row_from_hosts(k));
    std::map<unsigned int, Row> of_functions;
    for (unsigned int f = 0; f < classes.size(); ++f)
      if (classes[f] != inactive && levels.is_tied(f))
        of_functions[f] = {{spline_space->function_position(f), 1.}};
    for (unsigned int k = 0; k < functions.numbers.size(); ++k)
      of_functions[functions.numbers[k]] = std::move(rows[k]);
    rows.clear();
    functions = ExtendedFunctions();
    for (auto &entry : of_functions)
      {
        classes[entry.first] = extended;
        functions.numbers.push_back(entry.first);
        rows.push_back(std::move(entry.second));
      }
    levels.resolve(rows);
    for (const Row &row : rows)
      {
        append(row);
        functions.rows.begin.push_back(functions.rows.positions.size());
      }
  }



  template <int dim>
  void
  Extension<dim>::append(const Row &row)
  {
    for (const auto &entry : row)
      {
        functions.rows.positions.push_back(entry.first);
        functions.rows.weights.push_back(entry.second);
      }
  }



  template <int dim>
  double
  Extension<dim>::square_of_distance(const MultiIndex<dim>      &host,
                                     const MultiIndex<dim>      &function,
                                     const std::array<int, dim> &periods) const
  {
    const int                 p       = spline_space->degree();
    const auto               &lattice = spline_space->lattice();
    const CellHierarchy<dim> *all     = lattice.hierarchy();
    double                    result  = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        double distance = 2. * host[d] - (2. * function[d] - p) -
                          2. * lattice.n_cells()[d] * periods[d];
        if (all)
          {
            const unsigned int l    = all->level_of_function(function[0]);
            const int          at   = function[d] - all->offset(l)[d];
            const int          half = 1 << (all->n_levels() - 1 - l);
            distance = double(all->center(host)[d] - (2 * at - p + 1) * half) /
                       all->width(host);
          }
        result += distance * distance;
      }
    return result;
  }



  template <int dim>
  void
  Extension<dim>::row(const unsigned int          function,
                      std::vector<std::uint64_t> &positions,
                      std::vector<double>        &weights) const
  {
    const auto place = std::lower_bound(functions.numbers.begin(),
                                        functions.numbers.end(),
                                        function);
    Require(place != functions.numbers.end() && *place == function,
            "The function is not extended.");
    const unsigned int k     = place - functions.numbers.begin();
    const std::size_t  begin = functions.rows.begin[k],
                      end    = functions.rows.begin[k + 1];
    positions.assign(functions.rows.positions.begin() + begin,
                     functions.rows.positions.begin() + end);
    weights.assign(functions.rows.weights.begin() + begin,
                   functions.rows.weights.begin() + end);
  }



  template <int dim>
  typename Extension<dim>::Row
  Extension<dim>::row_from_hosts(const unsigned int k) const
  {
    const SplineSpace<dim> &space   = *spline_space;
    const auto             &hosts   = functions.hosts;
    const unsigned int      p       = space.degree();
    const auto             &extents = space.n_functions();
    const auto              i =
      multi_index<dim>(space.function_position(functions.numbers[k]), extents);
    MultiIndex<dim> local_extents;
    local_extents.fill(p + 1);
    const unsigned int n = space.n_dofs_per_cell();

    const std::size_t begin = functions.hosts_begin[k],
                      end   = functions.hosts_begin[k + 1];

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
        std::array<int, dim> shifts;
        for (unsigned int d = 0; d < dim; ++d)
          shifts[d] = periods(host[d], d);
        shares[h - begin] = square_of_distance(host, i, shifts);
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

    Row entries;
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
                for (int j = 0; j <= int(p); ++j)
                  factors[d][j] = j == std::clamp(nearest, 0, int(p));
                continue;
              }
            const double move =
              (lattice.upper()[d] - lattice.lower()[d]) * periods(host[d], d);
            double inner_knots[SplineSpace<dim>::max_degree];
            for (unsigned int j = 0; j < p; ++j)
              inner_knots[j] = space.knots(d).knots()[i[d] + 1 + j] + move;
            space.knots(d).blossom(host[d],
                                   ArrayView<const double>(inner_knots, p),
                                   ArrayView<double>(factors[d], p + 1));
          }
        for (unsigned int l = 0; l < n; ++l)
          {
            auto   a      = multi_index<dim>(l, local_extents);
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
    Row result;
    for (const auto &entry : entries)
      if (!result.empty() && result.back().first == entry.first)
        result.back().second += entry.second;
      else
        result.push_back(entry);
    return result;
  }



  template <int dim>
  typename Extension<dim>::Counts
  Extension<dim>::counts() const
  {
    Counts result;
    // A run may end before the first sums on a new grid.
    if (!spline_space)
      return result;
    std::vector<std::uint64_t> n(4);
    for (unsigned int f = 0; f < spline_space->owned_functions().size(); ++f)
      ++n[classes[f]];
    Utilities::MPI::sum(n, spline_space->communicator(), n);
    result.stable   = n[stable];
    result.extended = n[extended];
    result.lumped   = n[lumped];
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(Extension);
} // namespace greville

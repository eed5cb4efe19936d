// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/cell_filling.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  CellFilling<dim>::reinit(const SplineSpace<dim> &space, const Walls &walls)
  {
    spline_space  = &space;
    contact_walls = walls;
    neighbors.reinit(space);
    const auto &positions = neighbors.positions();
    classes.assign(positions.size(), empty);
    hosts.assign(positions.size(), none);
    filled.clear();
  }



  template <int dim>
  bool
  CellFilling<dim>::is_at_contact_wall(const MultiIndex<dim> &function,
                                       const MultiIndex<dim> &n) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if ((contact_walls[2 * d] && function[d] == 0) ||
          (contact_walls[2 * d + 1] && function[d] + 1 == n[d]))
        return true;
    return false;
  }



  template <int dim>
  bool
  CellFilling<dim>::update(const std::vector<double> &filling,
                           const double               threshold)
  {
    const unsigned int n_owned = spline_space->owned_cells().size();
    AssertDimension(filling.size(), n_owned);
    all_are_hosts            = threshold == 0.;
    unsigned int has_changed = 0;
    for (unsigned int c = 0; c < n_owned; ++c)
      {
        const unsigned char now = filling[c] <= 0.          ? empty
                                  : filling[c] >= threshold ? well_filled
                                                            : cut;
        has_changed |= now != classes[c];
        classes[c] = now;
      }
    if (Utilities::MPI::max(has_changed, spline_space->communicator()) == 0)
      return false;
    filled.clear();
    for (unsigned int c = 0; c < n_owned; ++c)
      if (classes[c] != empty)
        filled.push_back(c);
    find_hosts();
    return true;
  }



  template <int dim>
  void
  CellFilling<dim>::find_hosts()
  {
    const auto        &extents   = spline_space->lattice().n_cells();
    const unsigned int n_owned   = spline_space->owned_cells().size();
    const auto        &positions = neighbors.positions();

    std::vector<double> values(positions.size());
    const auto          exchange_cells = [&](const auto &get, const auto &set) {
      for (unsigned int c = 0; c < n_owned; ++c)
        values[c] = get(c);
      neighbors.exchange(values);
      for (unsigned int c = n_owned; c < positions.size(); ++c)
        set(c, values[c]);
    };
    // Positions travel as doubles, exactly; -1 is no host.
    const auto exchange_hosts = [&]() {
      exchange_cells(
        [&](const unsigned int c) {
          return hosts[c] == none ? -1. : double(hosts[c]);
        },
        [&](const unsigned int c, const double value) {
          hosts[c] = value < 0. ? none : std::uint64_t(value);
        });
    };

    exchange_cells([&](const unsigned int c) { return double(classes[c]); },
                   [&](const unsigned int c, const double value) {
                     classes[c] = static_cast<unsigned char>(value);
                   });
    MultiIndex<dim> three;
    three.fill(3);
    constexpr unsigned int n_neighbors = Utilities::pow(3, dim);

    // Whether the cell and its neighbours are well-filled, in 3D those by
    // faces.
    const auto is_inside_body = [&](const unsigned int c) {
      const auto index = multi_index<dim>(positions[c], extents);
      for (unsigned int k = 0; k < n_neighbors; ++k)
        {
          const auto      offset = multi_index<dim>(k, three);
          MultiIndex<dim> neighbor;
          bool            is_not_looked_at = false;
          unsigned int    n_sides          = 0;
          for (unsigned int d = 0; d < dim; ++d)
            n_sides += offset[d] != 1;
          if (dim == 3 && n_sides > 1)
            continue;
          for (unsigned int d = 0; d < dim; ++d)
            {
              neighbor[d] = index[d] + offset[d] - 1;
              if (neighbor[d] < extents[d])
                continue;
              if (extents[d] > 2 && !contact_walls[2 * d + offset[d] / 2])
                return false;
              is_not_looked_at = true;
            }
          if (is_not_looked_at)
            continue;
          const unsigned int n =
            neighbors.find(lexicographic<dim>(neighbor, extents));
          if (n == dealii::numbers::invalid_unsigned_int ||
              classes[n] != well_filled)
            return false;
        }
      return true;
    };

    // The best host that a neighbour has.
    const auto host_of_neighbors = [&](const unsigned int c) {
      const auto    index = multi_index<dim>(positions[c], extents);
      std::uint64_t best = none, best_distance = none;
      for (unsigned int k = 0; k < n_neighbors; ++k)
        {
          const auto      offset = multi_index<dim>(k, three);
          MultiIndex<dim> neighbor;
          bool            is_inside = true;
          for (unsigned int d = 0; d < dim; ++d)
            {
              neighbor[d] = index[d] + offset[d] - 1;
              is_inside   = is_inside && neighbor[d] < extents[d];
            }
          if (!is_inside)
            continue;
          const unsigned int n =
            neighbors.find(lexicographic<dim>(neighbor, extents));
          if (n == dealii::numbers::invalid_unsigned_int || hosts[n] == none)
            continue;
          const auto    host     = multi_index<dim>(hosts[n], extents);
          std::uint64_t distance = 0;
          for (unsigned int d = 0; d < dim; ++d)
            {
              const std::int64_t difference =
                std::int64_t(host[d]) - std::int64_t(index[d]);
              distance += difference * difference;
            }
          if (distance < best_distance ||
              (distance == best_distance && hosts[n] < best))
            {
              best          = hosts[n];
              best_distance = distance;
            }
        }
      return best;
    };

    std::fill(hosts.begin(), hosts.end(), none);
    std::vector<unsigned int> orphans = filled;
    const auto                adopt   = [&](const auto &find_host) {
      // All cells look at the hosts of the sweep before.
      std::vector<std::pair<unsigned int, std::uint64_t>> found;
      for (const unsigned int c : orphans)
        {
          const std::uint64_t host = find_host(c);
          if (host != none)
            found.emplace_back(c, host);
        }
      for (const auto &entry : found)
        hosts[entry.first] = entry.second;
      orphans.erase(std::remove_if(orphans.begin(),
                                   orphans.end(),
                                   [&](const unsigned int c) {
                                     return hosts[c] != none;
                                   }),
                    orphans.end());
      exchange_hosts();
    };
    if (all_are_hosts)
      {
        adopt([&](const unsigned int c) { return positions[c]; });
        return;
      }
    adopt([&](const unsigned int c) {
      return is_inside_body(c) ? positions[c] : none;
    });
    for (unsigned int sweep = 0; sweep < reach; ++sweep)
      adopt(host_of_neighbors);
  }



  template <int dim>
  std::uint64_t
  CellFilling<dim>::n_fragments() const
  {
    std::uint64_t n = 0;
    for (const unsigned int c : filled)
      n += hosts[c] == none;
    return Utilities::MPI::sum(n, spline_space->communicator());
  }



  template class CellFilling<2>;
  template class CellFilling<3>;
} // namespace greville

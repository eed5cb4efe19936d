// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/cell_filling.h>

#include <algorithm>
#include <tuple>

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
    // Other than any class: the first update() is a change also where no cell
    // has points.
    classes.assign(positions.size(), 255);
    hosts.assign(positions.size(), none);
    filled.clear();
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
    const auto        &lattice   = spline_space->lattice();
    const auto        &extents   = lattice.n_cells();
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
    // Call visit(offset, index) for the neighbours of a cell and itself: the
    // offset is 0, 1, or 2 in each direction, and the index lies beyond the
    // extents behind walls.
    const auto for_each_neighbor = [&](const unsigned int c,
                                       const auto        &visit) {
      constexpr unsigned int n_neighbors = Utilities::pow(3, dim);
      MultiIndex<dim>        three;
      three.fill(3);
      const auto index = multi_index<dim>(positions[c], extents);
      for (unsigned int k = 0; k < n_neighbors; ++k)
        {
          const auto offset   = multi_index<dim>(k, three);
          auto       neighbor = index;
          for (unsigned int d = 0; d < dim; ++d)
            neighbor[d] += offset[d] - 1;
          lattice.wrap(neighbor);
          visit(offset, neighbor);
        }
    };
    const auto find = [&](const MultiIndex<dim> &index) {
      for (unsigned int d = 0; d < dim; ++d)
        if (index[d] >= extents[d])
          return dealii::numbers::invalid_unsigned_int;
      return neighbors.find(lexicographic<dim>(index, extents));
    };

    // Whether the cell and its neighbours are well-filled, in 3D those by
    // faces.
    const auto is_inside_body = [&](const unsigned int c) {
      bool result = true;
      for_each_neighbor(
        c, [&](const MultiIndex<dim> &offset, const MultiIndex<dim> &neighbor) {
          if (!result ||
              (dim == 3 &&
               dim - std::count(offset.begin(), offset.end(), 1u) > 1))
            return;
          bool is_behind_wall = false;
          for (unsigned int d = 0; d < dim; ++d)
            if (neighbor[d] >= extents[d])
              {
                is_behind_wall = true;
                if (extents[d] > 2 && !contact_walls[2 * d + offset[d] / 2])
                  result = false;
              }
          if (is_behind_wall)
            return;
          const unsigned int n = find(neighbor);
          if (n == dealii::numbers::invalid_unsigned_int ||
              classes[n] != well_filled)
            result = false;
        });
      return result;
    };

    // The best host that a neighbour has.
    const auto host_of_neighbors = [&](const unsigned int c) {
      const auto index = multi_index<dim>(positions[c], extents);
      // Distance, the order among those equally far, and host.
      auto best = std::make_tuple(none, none, none);
      for_each_neighbor(
        c, [&](const MultiIndex<dim> &, const MultiIndex<dim> &neighbor) {
          const unsigned int n = find(neighbor);
          if (n == dealii::numbers::invalid_unsigned_int || hosts[n] == none)
            return;
          const auto    host     = multi_index<dim>(hosts[n], extents);
          std::uint64_t distance = 0, way = 0;
          for (int d = dim - 1; d >= 0; --d)
            {
              const int steps = lattice.steps(index[d], host[d], d);
              distance += steps * steps;
              way = way * (4 * reach) + (2 * reach + steps);
            }
          best = std::min(best, std::make_tuple(distance, way, hosts[n]));
        });
      return std::get<2>(best);
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



  template class CellFilling<2>;
  template class CellFilling<3>;
} // namespace greville

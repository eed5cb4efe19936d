// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/cell_filling.h>

#include <algorithm>
#include <limits>
#include <set>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  CellFilling<dim>::reinit(const SplineSpace<dim> &space,
                           const Walls            &walls,
                           const bool              with_rims)
  {
    spline_space  = &space;
    contact_walls = walls;
    has_rims      = with_rims;
    neighbors.reinit(space);
    const auto &positions = neighbors.positions();
    // This value is no class, so that the first update() is always a change.
    classes.assign(positions.size(), 255);
    given.assign(space.owned_cells().size(), 255);
    filled.clear();
  }



  template <int dim>
  bool
  CellFilling<dim>::update(const std::vector<double> &filling,
                           const double               threshold,
                           const bool                 with_outer_hosts)
  {
    const unsigned int n_owned = spline_space->owned_cells().size();
    AssertThrow(filling.size() == n_owned,
                ExcDimensionMismatch(filling.size(), n_owned));
    all_are_hosts                          = threshold == 0.;
    unsigned int               has_changed = 0;
    std::vector<unsigned char> now(n_owned);
    for (unsigned int c = 0; c < n_owned; ++c)
      {
        now[c] = filling[c] < 0.           ? beyond
                 : filling[c] == 0.        ? empty
                 : filling[c] >= threshold ? well_filled
                                           : cut;
        has_changed |= now[c] != given[c];
      }
    if (Utilities::MPI::max(has_changed, spline_space->communicator()) == 0)
      return false;
    std::copy(now.begin(), now.end(), classes.begin());
    given = std::move(now);
    find_hosts(with_outer_hosts);
    return true;
  }



  /// The steps of find_hosts() and their common data.
  template <int dim>
  struct CellFilling<dim>::HostSearch
  {
    using Cells = std::vector<unsigned int>;
    CellFilling<dim> &filling;

    const Lattice<dim>         &lattice   = filling.spline_space->lattice();
    const MultiIndex<dim>      &extents   = lattice.n_cells();
    const CellNeighbors<dim>   &neighbors = filling.neighbors;
    std::vector<unsigned char> &classes   = filling.classes;
    std::vector<std::pair<unsigned int, std::uint64_t>> &hosts_of_cells =
      filling.hosts_of_cells;
    const std::vector<std::uint64_t> &positions = neighbors.positions();
    const unsigned int n_owned = filling.spline_space->owned_cells().size();

    static MultiIndex<dim>
    three()
    {
      MultiIndex<dim> result;
      result.fill(3);
      return result;
    }

    /// Call visit(offset, index) for a cell and its neighbours: the offset is
    /// 0, 1, or 2 in each direction, and the index is beyond the extents behind
    /// walls.
    template <typename Visit>
    void
    for_each_neighbor(const unsigned int c, const Visit &visit) const
    {
      constexpr unsigned int n_neighbors = Utilities::pow(3, dim);
      const auto             index = multi_index<dim>(positions[c], extents);
      for (unsigned int k = 0; k < n_neighbors; ++k)
        {
          const auto offset   = multi_index<dim>(k, three());
          auto       neighbor = index;
          for (unsigned int d = 0; d < dim; ++d)
            neighbor[d] += offset[d] - 1;
          lattice.wrap(neighbor);
          visit(offset, neighbor);
        }
    }

    unsigned int
    find(const MultiIndex<dim> &index) const
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (index[d] >= extents[d])
          return numbers::invalid_unsigned_int;
      return neighbors.find(lexicographic<dim>(index, extents));
    }

    int
    square_of_steps(const MultiIndex<dim> &a, const MultiIndex<dim> &b) const
    {
      int distance = 0;
      for (unsigned int d = 0; d < dim; ++d)
        distance += Utilities::fixed_power<2>(lattice.steps(a[d], b[d], d));
      return distance;
    }

    /// Mark the empty cells around cells with points as beyond the body.
    void
    mark_rims()
    {
      std::vector<unsigned int> rims;
      for (unsigned int c = 0; c < n_owned; ++c)
        if (classes[c] == empty)
          {
            bool is_rim = false;
            for_each_neighbor(c, [&](const auto &, const auto &neighbor) {
              const unsigned int n = find(neighbor);
              is_rim = is_rim || (n != numbers::invalid_unsigned_int &&
                                  filling.holds_points(n));
            });
            if (is_rim)
              rims.push_back(c);
          }
      for (const unsigned int c : rims)
        classes[c] = beyond;
      neighbors.exchange(classes);
    }

    /// Return whether the cell and its neighbours, in 3D its face neighbours,
    /// are well-filled.
    bool
    is_inside_body(const unsigned int c) const
    {
      bool result = true;
      for_each_neighbor(c, [&](const auto &offset, const auto &neighbor) {
        if (!result || (dim == 3 &&
                        dim - std::count(offset.begin(), offset.end(), 1u) > 1))
          return;
        bool is_behind_wall = false;
        for (unsigned int d = 0; d < dim; ++d)
          if (neighbor[d] >= extents[d])
            {
              is_behind_wall = true;
              if (extents[d] > 2 &&
                  !filling.contact_walls[2 * d + offset[d] / 2])
                result = false;
            }
        if (is_behind_wall)
          return;
        const unsigned int n = find(neighbor);
        if (n == numbers::invalid_unsigned_int || classes[n] != well_filled)
          result = false;
      });
      return result;
    }

    /// Make cells inside the body hosts, and return the other filled cells.
    Cells
    choose_hosts()
    {
      Cells inside, outside;
      for (const unsigned int c : filling.filled)
        ((filling.all_are_hosts && filling.holds_points(c)) || is_inside_body(c)
           ? inside
           : outside)
          .push_back(c);
      for (const unsigned int c : inside)
        classes[c] = host;
      neighbors.exchange(classes);
      return outside;
    }

    /// Return which neighbours of cells are their nearest hosts, as bits.
    std::vector<std::uint32_t>
    find_nearest_neighbors(const Cells &cells)
    {
      std::vector<std::uint32_t> near(positions.size(), 0);
      for (const unsigned int c : cells)
        {
          int nearest = dim + 1;
          for_each_neighbor(c, [&](const auto &offset, const auto &neighbor) {
            const unsigned int n = find(neighbor);
            const int          distance =
              dim - std::count(offset.begin(), offset.end(), 1u);
            if (n == numbers::invalid_unsigned_int || classes[n] != host ||
                distance > nearest)
              return;
            if (distance < nearest)
              near[c] = 0;
            nearest = distance;
            near[c] |= std::uint32_t{1} << lexicographic<dim>(offset, three());
          });
        }
      neighbors.exchange(near);
      return near;
    }

    /// Append the nearest hosts of a cell. A cell without a host as neighbour
    /// takes the nearest hosts of its neighbours.
    void
    append_hosts_of(const unsigned int                c,
                    const std::vector<std::uint32_t> &near)
    {
      const std::size_t begin    = hosts_of_cells.size();
      const auto        index    = multi_index<dim>(positions[c], extents);
      int               nearest  = std::numeric_limits<int>::max();
      const auto        add_near = [&](const unsigned int n) {
        if (near[n] == 0)
          return;
        for_each_neighbor(n, [&](const auto &offset, const auto &found) {
          if ((near[n] >> lexicographic<dim>(offset, three()) & 1) == 0)
            return;
          const int distance = square_of_steps(index, found);
          if (distance < nearest)
            hosts_of_cells.resize(begin);
          nearest = std::min(nearest, distance);
          if (distance == nearest)
            hosts_of_cells.emplace_back(c, lexicographic<dim>(found, extents));
        });
      };
      if (near[c] != 0)
        add_near(c);
      else
        for_each_neighbor(c, [&](const auto &, const auto &neighbor) {
          const unsigned int n = find(neighbor);
          if (n != numbers::invalid_unsigned_int)
            add_near(n);
        });
      const auto first = hosts_of_cells.begin() + begin;
      std::sort(first, hosts_of_cells.end());
      hosts_of_cells.erase(std::unique(first, hosts_of_cells.end()),
                           hosts_of_cells.end());
    }

    /// Find hosts of cells, and return the cells that have none.
    Cells
    find_hosts_of(const Cells &cells)
    {
      const std::vector<std::uint32_t> near = find_nearest_neighbors(cells);
      Cells                            without;
      for (const unsigned int c : cells)
        {
          const std::size_t begin = hosts_of_cells.size();
          append_hosts_of(c, near);
          if (hosts_of_cells.size() == begin)
            without.push_back(c);
        }
      return without;
    }

    /// Return the hosts of all local cells.
    std::vector<std::vector<std::uint64_t>>
    exchange_hosts()
    {
      std::vector<std::vector<std::uint64_t>> lists(positions.size());
      for (const auto &entry : hosts_of_cells)
        lists[entry.first].push_back(entry.second);
      std::size_t n_rounds = 0;
      for (const auto &list : lists)
        n_rounds = std::max(n_rounds, list.size());
      n_rounds =
        Utilities::MPI::max(n_rounds, filling.spline_space->communicator());
      for (unsigned int r = 0; r < n_rounds; ++r)
        {
          // Positions plus one are exchanged; 0 means none.
          std::vector<double> travelling(positions.size(), 0.);
          for (unsigned int c = 0; c < n_owned; ++c)
            if (r < lists[c].size())
              travelling[c] = double(lists[c][r] + 1);
          neighbors.exchange(travelling);
          for (unsigned int c = n_owned; c < positions.size(); ++c)
            if (travelling[c] > 0.)
              lists[c].push_back(std::uint64_t(travelling[c]) - 1);
        }
      return lists;
    }

    /// Give cells beyond the body the nearest hosts of their neighbours, and
    /// return the cells that have none.
    Cells
    find_hosts_of_rims(const Cells &cells)
    {
      const auto lists = exchange_hosts();
      Cells      without;
      for (const unsigned int c : cells)
        if (classes[c] == beyond)
          {
            const auto index   = multi_index<dim>(positions[c], extents);
            int        nearest = std::numeric_limits<int>::max();
            std::set<std::uint64_t> found;
            for_each_neighbor(c, [&](const auto &, const auto &neighbor) {
              const unsigned int n = find(neighbor);
              if (n == numbers::invalid_unsigned_int || n == c)
                return;
              for (const std::uint64_t position : lists[n])
                {
                  const int distance =
                    square_of_steps(index, multi_index<dim>(position, extents));
                  if (distance < nearest)
                    found.clear();
                  nearest = std::min(nearest, distance);
                  if (distance == nearest)
                    found.insert(position);
                }
            });
            for (const std::uint64_t position : found)
              hosts_of_cells.emplace_back(c, position);
            if (found.empty())
              without.push_back(c);
          }
        else
          without.push_back(c);
      std::sort(hosts_of_cells.begin(), hosts_of_cells.end());
      return without;
    }
  };



  template <int dim>
  void
  CellFilling<dim>::find_hosts(const bool with_outer_hosts)
  {
    HostSearch search{*this};
    search.neighbors.exchange(classes);
    if (has_rims)
      search.mark_rims();
    filled.clear();
    for (unsigned int c = 0; c < search.n_owned; ++c)
      if (classes[c] != empty)
        filled.push_back(c);
    const std::vector<unsigned int> outside = search.choose_hosts();

    hosts_of_cells.clear();
    std::vector<unsigned int> fragments = search.find_hosts_of(outside);
    if (has_rims)
      fragments = search.find_hosts_of_rims(fragments);
    if (!with_outer_hosts)
      return;
    std::vector<unsigned int> cut_fragments;
    for (const unsigned int c : fragments)
      if (classes[c] == well_filled)
        classes[c] = host;
      else
        cut_fragments.push_back(c);
    search.neighbors.exchange(classes);
    fragments = search.find_hosts_of(cut_fragments);
    if (has_rims)
      search.find_hosts_of_rims(fragments);
    std::sort(hosts_of_cells.begin(), hosts_of_cells.end());
  }



  GREVILLE_INSTANTIATE_CLASS(CellFilling);
} // namespace greville

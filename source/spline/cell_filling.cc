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
    // 255 is no class, so that the first update() always reports a change.
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
    const CellHierarchy<dim>   *levels    = lattice.hierarchy();
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
    /// walls. Several neighbours of another level can have the same offset, and
    /// one neighbour several offsets.
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
          if (levels)
            visit_active(index, offset, neighbor, visit);
          else
            {
              lattice.wrap(neighbor);
              visit(offset, neighbor);
            }
        }
    }

    /// Call visit(offset, index) for the active cells at the place of a
    /// @p neighbor, which has the level of the cell @p index.
    template <typename Visit>
    void
    visit_active(const MultiIndex<dim> &index,
                 const MultiIndex<dim> &offset,
                 MultiIndex<dim>        neighbor,
                 const Visit           &visit) const
    {
      const unsigned int l = levels->level(index);
      if (levels->level(neighbor) != l)
        {
          for (unsigned int d = 0; d < dim; ++d)
            if (offset[d] == 0 ? lattice.is_first(d, index[d])
                               : offset[d] == 2 && lattice.is_last(d, index[d]))
              neighbor[d] = numbers::invalid_unsigned_int;
          visit(offset, neighbor);
        }
      else if (levels->is_refined(neighbor))
        for (unsigned int k = 0; k < Utilities::pow(2, dim); ++k)
          {
            MultiIndex<dim> child;
            bool            touches = true;
            for (unsigned int d = 0; d < dim; ++d)
              {
                const unsigned int upper = (k >> d) & 1;
                touches  = touches && offset[d] != (upper ? 2u : 0u);
                child[d] = levels->offset(l + 1)[d] +
                           2 * (neighbor[d] - levels->offset(l)[d]) + upper;
              }
            if (touches)
              visit(offset, child);
          }
      else
        visit(offset,
              levels->is_active(neighbor) ? neighbor
                                          : levels->parent(neighbor));
    }

    /// Return the number of cells of the level of a cell in a direction.
    unsigned int
    n_cells(const unsigned int c, const unsigned int d) const
    {
      return levels ? levels->n_cells(levels->level(
                        multi_index<dim>(positions[c], extents)))[d]
                    : extents[d];
    }

    unsigned int
    find(const MultiIndex<dim> &index) const
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (index[d] >= extents[d])
          return numbers::invalid_unsigned_int;
      return neighbors.find(lexicographic<dim>(index, extents));
    }

    /// Return the squared distance from a cell to a host, in units of the
    /// host's size.
    double
    square_of_steps(const MultiIndex<dim> &a, const MultiIndex<dim> &host) const
    {
      double result = 0.;
      if (levels)
        {
          const auto center = levels->center(a), at = levels->center(host);
          for (unsigned int d = 0; d < dim; ++d)
            result += Utilities::fixed_power<2>((at[d] - center[d]) /
                                                (2. * levels->width(host)));
        }
      else
        for (unsigned int d = 0; d < dim; ++d)
          result += Utilities::fixed_power<2>(lattice.steps(a[d], host[d], d));
      return result;
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
              if (n_cells(c, d) > 2 &&
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
      double            nearest  = std::numeric_limits<double>::max();
      const auto        add_near = [&](const unsigned int n) {
        if (near[n] == 0)
          return;
        for_each_neighbor(n, [&](const auto &offset, const auto &found) {
          if ((near[n] >> lexicographic<dim>(offset, three()) & 1) == 0)
            return;
          const double distance = square_of_steps(index, found);
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
      if (levels)
        return find_hosts_on_levels(cells);
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

    using Lists = std::vector<std::vector<std::uint64_t>>;

    /// Return the hosts of all local cells.
    Lists
    exchange_hosts()
    {
      Lists lists(positions.size());
      for (const auto &entry : hosts_of_cells)
        lists[entry.first].push_back(entry.second);
      exchange_lists_of_cells(lists);
      return lists;
    }

    /// Collective. Set the lists of cells that are not owned.
    void
    exchange_lists_of_cells(Lists &lists)
    {
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
    }

    /// Collects the nearest hosts of a cell.
    struct Nearest
    {
      const HostSearch       &search;
      const MultiIndex<dim>   index;
      double                  distance = std::numeric_limits<double>::max();
      std::set<std::uint64_t> found    = {};

      void
      add(const std::uint64_t position)
      {
        const double d =
          search.square_of_steps(index,
                                 multi_index<dim>(position, search.extents));
        if (d < distance)
          found.clear();
        distance = std::min(d, distance);
        if (d == distance)
          found.insert(position);
      }

      void
      add_hosts_of_neighbors(const unsigned int c, const Lists &lists)
      {
        search.for_each_neighbor(c, [&](const auto &, const auto &neighbor) {
          const unsigned int n = search.find(neighbor);
          if (n != numbers::invalid_unsigned_int && n != c)
            for (const std::uint64_t position : lists[n])
              add(position);
        });
      }
    };

    /// Do the same as find_hosts_of() for cells of several levels. The distance
    /// from a host is measured in units of the host's size.
    Cells
    find_hosts_on_levels(const Cells &cells)
    {
      Lists near(positions.size());
      for (const unsigned int c : cells)
        {
          Nearest nearest{*this, multi_index<dim>(positions[c], extents)};
          for_each_neighbor(c, [&](const auto &, const auto &neighbor) {
            const unsigned int n = find(neighbor);
            if (n != numbers::invalid_unsigned_int && classes[n] == host)
              nearest.add(positions[n]);
          });
          near[c].assign(nearest.found.begin(), nearest.found.end());
        }
      exchange_lists_of_cells(near);
      Cells without;
      for (const unsigned int c : cells)
        {
          Nearest nearest{*this, multi_index<dim>(positions[c], extents)};
          for (const std::uint64_t position : near[c])
            nearest.add(position);
          if (near[c].empty())
            nearest.add_hosts_of_neighbors(c, near);
          for (const std::uint64_t position : nearest.found)
            hosts_of_cells.emplace_back(c, position);
          if (nearest.found.empty())
            without.push_back(c);
        }
      return find_hosts_behind_edges(without);
    }

    /// Give cells the hosts of their neighbours if these hosts are not farther
    /// away than hosts can be among equal cells. (Small cells beside large
    /// cells that are not hosts are three cells away from a host.) Return the
    /// cells that have none.
    Cells
    find_hosts_behind_edges(const Cells &cells)
    {
      constexpr double largest_square = 2. * 2. * dim;
      const Lists      lists          = exchange_hosts();
      Cells            without;
      for (const unsigned int c : cells)
        {
          Nearest nearest{*this, multi_index<dim>(positions[c], extents)};
          nearest.add_hosts_of_neighbors(c, lists);
          const bool is_near = nearest.distance <= largest_square;
          for (const std::uint64_t position : nearest.found)
            if (is_near)
              hosts_of_cells.emplace_back(c, position);
          if (!is_near)
            without.push_back(c);
        }
      std::sort(hosts_of_cells.begin(), hosts_of_cells.end());
      return without;
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
            Nearest nearest{*this, multi_index<dim>(positions[c], extents)};
            nearest.add_hosts_of_neighbors(c, lists);
            const auto &found = nearest.found;
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

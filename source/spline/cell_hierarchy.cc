// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/spline/cell_hierarchy.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Call visit(index) for all indices from @p first to @p last, both
    /// included, until it returns true. Returns whether it did.
    template <int dim, typename Visit>
    bool
    any_of(const MultiIndex<dim> &first,
           const MultiIndex<dim> &last,
           const Visit           &visit)
    {
      MultiIndex<dim> index = first;
      while (true)
        {
          if (visit(index))
            return true;
          unsigned int d = 0;
          while (d < dim && index[d] == last[d])
            {
              index[d] = first[d];
              ++d;
            }
          if (d == dim)
            return false;
          ++index[d];
        }
    }
  } // namespace



  template <int dim>
  CellHierarchy<dim>::CellHierarchy(const CellEdges<dim> &edges,
                                    const unsigned int    n_levels,
                                    const unsigned int    degree,
                                    const Wanted         &wanted)
    : wanted(wanted)
    , n_rings(degree == 2 ? 1 : degree)
    , offsets(n_levels + 1)
    , known_wanted(n_levels)
    , refined(n_levels)
  {
    for (unsigned int d = 0; d < dim; ++d)
      n_coarse[d] = edges[d].size() - 1;
    CellEdges<dim> all = edges, of_level = edges;
    offsets[0].fill(0);
    for (unsigned int l = 1; l <= n_levels; ++l)
      for (unsigned int d = 0; d < dim; ++d)
        {
          const std::vector<double> coarse = of_level[d];
          of_level[d].clear();
          for (unsigned int k = 0; k < coarse.size(); ++k)
            {
              if (k > 0)
                of_level[d].push_back(0.5 * (coarse[k - 1] + coarse[k]));
              of_level[d].push_back(coarse[k]);
            }
          // The edges in a gap make cells without a length.
          all[d].insert(all[d].end(), gap - 1, all[d].back());
          offsets[l][d] = all[d].size();
          all[d].insert(all[d].end(), of_level[d].begin(), of_level[d].end());
        }
    all_edges = std::make_shared<const CellEdges<dim>>(std::move(all));
  }



  template <int dim>
  MultiIndex<dim>
  CellHierarchy<dim>::n_cells(const unsigned int level) const
  {
    MultiIndex<dim> n = n_coarse;
    for (unsigned int d = 0; d < dim; ++d)
      n[d] <<= level;
    return n;
  }



  template <int dim>
  CellEdges<dim>
  CellHierarchy<dim>::finest_edges() const
  {
    CellEdges<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d].assign((*all_edges)[d].begin() + offsets.back()[d],
                       (*all_edges)[d].end());
    return result;
  }



  template <int dim>
  unsigned int
  CellHierarchy<dim>::level(const MultiIndex<dim> &index) const
  {
    for (unsigned int l = 0; l < n_levels(); ++l)
      {
        const auto n         = n_cells(l);
        bool       is_inside = true;
        for (unsigned int d = 0; d < dim; ++d)
          is_inside = is_inside && index[d] - offsets[l][d] < n[d];
        if (is_inside)
          return l;
      }
    return n_levels();
  }



  template <int dim>
  MultiIndex<dim>
  CellHierarchy<dim>::parent(const MultiIndex<dim> &index) const
  {
    const unsigned int l = level(index);
    AssertThrow(l > 0 && l < n_levels(), ExcInternalError());
    MultiIndex<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = offsets[l - 1][d] + (index[d] - offsets[l][d]) / 2;
    return result;
  }



  template <int dim>
  CellBox<dim>
  CellHierarchy<dim>::box(const unsigned int     level,
                          const MultiIndex<dim> &cell) const
  {
    CellBox<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        result.index[d]    = offsets[level][d] + cell[d];
        const double *edge = &(*all_edges)[d][result.index[d]];
        result.lower[d]    = edge[0];
        result.size[d]     = edge[1] - edge[0];
        result.center[d]   = 0.5 * (edge[0] + edge[1]);
      }
    return result;
  }



  template <int dim>
  std::shared_ptr<const CellHierarchy<dim>>
  CellHierarchy<dim>::refined_also(
    const std::vector<std::uint64_t> &positions) const
  {
    auto result = std::make_shared<CellHierarchy>(*this);
    result->want(positions);
    return result;
  }



  template <int dim>
  std::shared_ptr<const CellHierarchy<dim>>
  CellHierarchy<dim>::refined_only(
    const std::vector<std::uint64_t> &positions) const
  {
    auto result    = std::make_shared<CellHierarchy>(*this);
    result->wanted = [](const unsigned int, const CellBox<dim> &) {
      return false;
    };
    for (auto &of_level : result->known_wanted)
      of_level.clear();
    result->want(positions);
    return result;
  }



  template <int dim>
  void
  CellHierarchy<dim>::want(const std::vector<std::uint64_t> &positions)
  {
    for (auto &of_level : refined)
      of_level.clear();
    for (const std::uint64_t position : positions)
      {
        MultiIndex<dim> cell = index(position);
        unsigned int    l    = level(cell);
        for (unsigned int d = 0; d < dim; ++d)
          cell[d] -= offsets[l][d];
        while (true)
          {
            known_wanted[l][lexicographic<dim>(cell, n_cells(l))] = true;
            if (l == 0)
              break;
            --l;
            for (unsigned int &i : cell)
              i /= 2;
          }
      }
  }



  template <int dim>
  bool
  CellHierarchy<dim>::is_wanted(const unsigned int     level,
                                const MultiIndex<dim> &cell) const
  {
    const auto position = lexicographic<dim>(cell, n_cells(level));
    const auto known    = known_wanted[level].find(position);
    if (known != known_wanted[level].end())
      return known->second;
    if (level > 0)
      {
        MultiIndex<dim> parent = cell;
        for (unsigned int &i : parent)
          i /= 2;
        if (!is_wanted(level - 1, parent))
          return false;
      }
    return known_wanted[level][position] = wanted(level, box(level, cell));
  }



  template <int dim>
  bool
  CellHierarchy<dim>::find_refined(const unsigned int     level,
                                   const MultiIndex<dim> &cell) const
  {
    if (level + 1 >= n_levels())
      return false;
    // The cells that are refined together.
    MultiIndex<dim> first = cell, last = cell;
    if (level > 0)
      for (unsigned int d = 0; d < dim; ++d)
        {
          first[d] = cell[d] / 2 * 2;
          last[d]  = first[d] + 1;
        }
    const auto position = lexicographic<dim>(first, n_cells(level));
    const auto known    = refined[level].find(position);
    if (known != refined[level].end())
      return known->second;

    const auto grow = [&](const unsigned int by, const MultiIndex<dim> &n) {
      for (unsigned int d = 0; d < dim; ++d)
        {
          first[d] -= std::min(first[d], by);
          last[d] = std::min(last[d] + by, n[d] - 1);
        }
    };
    bool result = any_of<dim>(first, last, [&](const MultiIndex<dim> &c) {
      return is_wanted(level, c);
    });
    if (!result && level + 2 < n_levels())
      {
        // The rings around refined children may reach these cells. First look
        // for wanted cells nearby: a refined child is at most n_rings + 4 cells
        // away from one, since each level adds half of the rings and the
        // siblings.
        MultiIndex<dim> children = first, last_children = last;
        for (unsigned int d = 0; d < dim; ++d)
          {
            children[d] *= 2;
            last_children[d] = 2 * last_children[d] + 1;
          }
        grow(n_rings + 4, n_cells(level));
        result = any_of<dim>(first, last, [&](const MultiIndex<dim> &c) {
          return is_wanted(level, c);
        });
        first  = children;
        last   = last_children;
        grow(n_rings, n_cells(level + 1));
        result = result && any_of<dim>(first, last, [&](const auto &c) {
                   return find_refined(level + 1, c);
                 });
      }
    refined[level][position] = result;
    return result;
  }



  template <int dim>
  bool
  CellHierarchy<dim>::is_refined(const MultiIndex<dim> &index) const
  {
    const unsigned int l = level(index);
    if (l == n_levels())
      return false;
    MultiIndex<dim> cell = index;
    for (unsigned int d = 0; d < dim; ++d)
      cell[d] -= offsets[l][d];
    return find_refined(l, cell);
  }



  template <int dim>
  bool
  CellHierarchy<dim>::is_active(const MultiIndex<dim> &index) const
  {
    const unsigned int l = level(index);
    return l < n_levels() && !is_refined(index) &&
           (l == 0 || is_refined(parent(index)));
  }



  template <int dim>
  MultiIndex<dim>
  CellHierarchy<dim>::find(const Point<dim> &point) const
  {
    MultiIndex<dim> cell;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const auto begin = (*all_edges)[d].begin();
        cell[d] = std::upper_bound(begin + 1, begin + n_coarse[d], point[d]) -
                  begin - 1;
      }
    unsigned int l = 0;
    for (; find_refined(l, cell); ++l)
      for (unsigned int d = 0; d < dim; ++d)
        {
          cell[d] *= 2;
          cell[d] +=
            point[d] >= (*all_edges)[d][offsets[l + 1][d] + cell[d] + 1];
        }
    for (unsigned int d = 0; d < dim; ++d)
      cell[d] += offsets[l][d];
    return cell;
  }



  template <int dim>
  std::array<int, dim>
  CellHierarchy<dim>::center(const MultiIndex<dim> &index) const
  {
    const unsigned int   l = level(index);
    std::array<int, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = (2 * (index[d] - offsets[l][d]) + 1) << (n_levels() - 1 - l);
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(CellHierarchy);
} // namespace greville

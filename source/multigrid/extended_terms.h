// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/lattice_unknowns.h>

#include <algorithm>

namespace greville
{
  /// For the functions of a level that depend on unknowns, the coarse functions
  /// that interpolate them: the rows of E P.
  template <int dim>
  class ExtendedTerms
  {
  public:
    using Position = typename LatticeLevel<dim>::Position;

    /// A coarse function, counted from LatticeUnknowns::first_coarse().
    struct Term
    {
      Position     offset;
      float        weight;
      unsigned int level; // of cells
    };

    /// The offsets of the terms of a level of cells.
    struct Range
    {
      unsigned int level;
      Position     lowest, highest;
    };

    struct Terms
    {
      std::vector<Range> ranges;
      std::vector<Term>  list;
      unsigned char      constrained = 0; // components (bits) without terms
    };

    ExtendedTerms(const LatticeUnknowns<dim> &coarse,
                  const LatticeLevel<dim>    &fine);

    /// Return whether a function, or a column of its row, depends on unknowns.
    bool
    touches(const Position &i) const
    {
      const std::size_t at = boxes.place(i);
      return at < is_near.size() && is_near[at];
    }

    /// Return the coarse functions of a function that depends on unknowns;
    /// otherwise null.
    const Terms *
    find(const Position &i) const
    {
      const std::size_t at = boxes.place(i);
      if (at >= number_at.size())
        return nullptr;
      const unsigned int e = number_at[at];
      return e != none ? &rows[e] : nullptr;
    }

  private:
    static constexpr unsigned int none = static_cast<unsigned int>(-1);

    Terms
    insert(const Position                            &i,
           const typename LatticeLevel<dim>::Terms   &terms,
           const typename LatticeLevel<dim>::Lattice &lattice) const;

    /// Add the terms of a level from the sums of their weights in a box.
    static void
    add_terms(const unsigned int level,
              const LatticeBox  &box,
              const float       *sums,
              const Position    &first,
              Terms             &result);

    const LatticeUnknowns<dim> &coarse;
    std::vector<Terms>          rows;
    LatticeBoxes                boxes;
    std::vector<unsigned int>   number_at;
    std::vector<bool>           is_near;
  };



  template <int dim>
  ExtendedTerms<dim>::ExtendedTerms(const LatticeUnknowns<dim> &coarse,
                                    const LatticeLevel<dim>    &fine)
    : coarse(coarse)
  {
    const auto     lattice = fine.lattice();
    const int      p       = lattice[0].degree();
    const Position reach{{p, p, dim == 3 ? p : 0}};
    std::vector<std::pair<Position, unsigned int>> all;
    fine.for_each_extended([&](const Position &i, const auto &terms) {
      all.emplace_back(i, rows.size());
      rows.push_back(insert(i, terms, lattice));
    });
    std::sort(all.begin(), all.end());
    for (const auto &[i, bits] : fine.constrained_functions())
      {
        const auto found =
          std::lower_bound(all.begin(), all.end(), std::make_pair(i, 0u));
        if (found != all.end() && found->first == i)
          rows[found->second].constrained = bits;
      }
    add_periodic_images(lattice, reach, all);
    boxes.fit(lattice[0], all, reach);
    number_at.assign(boxes.size(), none);
    is_near.assign(boxes.size(), false);
    for (const auto &[i, e] : all)
      {
        number_at[boxes.place(i)] = e;
        for (int z = -reach[2]; z <= reach[2]; ++z)
          for (int y = -p; y <= p; ++y)
            for (int x = -p; x <= p; ++x)
              is_near[boxes.place({{i[0] + x, i[1] + y, i[2] + z}})] = true;
      }
  }



  template <int dim>
  typename ExtendedTerms<dim>::Terms
  ExtendedTerms<dim>::insert(
    const Position                            &i,
    const typename LatticeLevel<dim>::Terms   &terms,
    const typename LatticeLevel<dim>::Lattice &lattice) const
  {
    std::vector<std::pair<Position, float>> entries;
    for (const auto &[given, weight] : terms)
      {
        // Choose the image next to the function.
        Position u = given;
        for (unsigned int d = 0; d < 3; ++d)
          if (lattice[d].is_periodic())
            {
              const int period = lattice[d].n_functions();
              if (2 * (u[d] - i[d]) > period)
                u[d] -= period;
              else if (2 * (i[d] - u[d]) > period)
                u[d] += period;
            }
        coarse.for_each_coarse(u, [&](const Position &I, const float of_u) {
          entries.emplace_back(I, weight * of_u);
        });
      }
    Terms          result;
    const Position first = coarse.first_coarse(i);
    LatticeBoxes   boxes_of_terms;
    boxes_of_terms.fit(coarse.lattice()[0], entries, {{0, 0, 0}});
    std::vector<float> sums(boxes_of_terms.size(), 0.f);
    for (const auto &[I, weight] : entries)
      sums[boxes_of_terms.place(I)] += weight;
    const float *of_level = sums.data();
    for (unsigned int l = 0; l < boxes_of_terms.n_levels(); ++l)
      {
        add_terms(l, boxes_of_terms[l], of_level, first, result);
        of_level += boxes_of_terms[l].size();
      }
    return result;
  }



  template <int dim>
  void
  ExtendedTerms<dim>::add_terms(const unsigned int level,
                                const LatticeBox  &box,
                                const float       *sums,
                                const Position    &first,
                                Terms             &result)
  {
    constexpr float negligible = 1e-5f;
    Range           range{level, {}, {}};
    range.lowest.fill(std::numeric_limits<int>::max());
    range.highest.fill(-std::numeric_limits<int>::max());
    const std::size_t n_before = result.list.size();
    // Do not process neighbours in x one after another: loading a vector waits
    // for the store of a vector that overlaps it.
    for (int x = 0; x < box.extents[0]; ++x)
      for (std::size_t place = x; place < box.size(); place += box.extents[0])
        if (std::abs(sums[place]) > negligible)
          {
            Term term{box.position(place), sums[place], level};
            for (unsigned int d = 0; d < 3; ++d)
              {
                term.offset[d] -= first[d];
                range.lowest[d]  = std::min(range.lowest[d], term.offset[d]);
                range.highest[d] = std::max(range.highest[d], term.offset[d]);
              }
            result.list.push_back(term);
          }
    if (result.list.size() > n_before)
      result.ranges.push_back(range);
  }
} // namespace greville

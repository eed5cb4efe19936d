// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/nested_knots.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace greville
{
  /// A box of positions, numbered in lexicographic order.
  struct LatticeBox
  {
    using Position = std::array<int, 3>;

    /// Set the smallest box around the first members of pairs, with a margin.
    template <typename Pairs>
    void
    fit(const Pairs &pairs, const Position &margin)
    {
      Position high;
      low.fill(std::numeric_limits<int>::max());
      high.fill(-std::numeric_limits<int>::max());
      for (const auto &pair : pairs)
        for (unsigned int d = 0; d < 3; ++d)
          {
            low[d]  = std::min(low[d], pair.first[d] - margin[d]);
            high[d] = std::max(high[d], pair.first[d] + margin[d]);
          }
      for (unsigned int d = 0; d < 3; ++d)
        extents[d] = pairs.empty() ? 0 : high[d] + 1 - low[d];
    }

    std::size_t
    size() const
    {
      return std::size_t(extents[0]) * extents[1] * extents[2];
    }

    bool
    contains(const Position &i) const
    {
      for (unsigned int d = 0; d < 3; ++d)
        if (i[d] < low[d] || i[d] >= low[d] + extents[d])
          return false;
      return true;
    }

    std::size_t
    place(const Position &i) const
    {
      return (std::size_t(i[2] - low[2]) * extents[1] + (i[1] - low[1])) *
               extents[0] +
             (i[0] - low[0]);
    }

    Position
    position(const std::size_t place) const
    {
      return {{low[0] + int(place % extents[0]),
               low[1] + int(place / extents[0] % extents[1]),
               low[2] + int(place / extents[0] / extents[1])}};
    }

    Position low{}, extents{};
  };



  /// Boxes around positions of each level of a lattice, numbered one box after
  /// another. Boxes of different levels have no common positions.
  class LatticeBoxes
  {
  public:
    using Position = LatticeBox::Position;

    /// Set the smallest boxes around the first members of pairs, with a margin.
    /// @p knots are the knots of a direction.
    template <typename Pairs>
    void
    fit(const NestedKnots &knots, const Pairs &pairs, const Position &margin)
    {
      boxes.assign(knots.n_levels(), LatticeBox());
      begin.assign(1, 0);
      std::vector<Pairs> of_levels(boxes.size() > 1 ? boxes.size() : 0);
      if (boxes.size() > 1)
        for (const auto &pair : pairs)
          of_levels[knots.level(pair.first[0])].push_back(pair);
      for (unsigned int l = 0; l < boxes.size(); ++l)
        {
          boxes[l].fit(boxes.size() > 1 ? of_levels[l] : pairs, margin);
          begin.push_back(begin.back() + boxes[l].size());
        }
    }

    const LatticeBox &
    operator[](const unsigned int level) const
    {
      return boxes[level];
    }

    unsigned int
    n_levels() const
    {
      return boxes.size();
    }

    std::size_t
    size() const
    {
      return begin.back();
    }

    /// Return the place of a position, or size() if no box contains it.
    std::size_t
    place(const Position &i) const
    {
      for (unsigned int l = 0; l < boxes.size(); ++l)
        if (boxes[l].contains(i))
          return begin[l] + boxes[l].place(i);
      return size();
    }

    Position
    position(const std::size_t place) const
    {
      unsigned int l = 0;
      while (place >= begin[l + 1])
        ++l;
      return boxes[l].position(place - begin[l]);
    }

  private:
    std::vector<LatticeBox>  boxes;
    std::vector<std::size_t> begin = {0};
  };



  /// Append the images in periodic directions, up to a margin, of the first
  /// members of pairs.
  template <typename Pairs>
  void
  add_periodic_images(const std::array<NestedKnots, 3> &lattice,
                      const std::array<int, 3>         &margin,
                      Pairs                            &pairs)
  {
    for (unsigned int d = 0; d < 3; ++d)
      if (lattice[d].is_periodic())
        for (std::size_t k = 0, n_before = pairs.size(); k < n_before; ++k)
          for (const int sign : {-1, 1})
            {
              const int n     = lattice[d].n_functions();
              auto      image = pairs[k];
              image.first[d] += sign * n;
              if (image.first[d] >= -margin[d] &&
                  image.first[d] < n + margin[d])
                pairs.push_back(image);
            }
  }
} // namespace greville

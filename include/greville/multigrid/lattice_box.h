// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

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

    /// Extend the box to a position with a margin.
    void
    include(const Position &i, const Position &margin)
    {
      for (unsigned int d = 0; d < 3; ++d)
        {
          const int begin = i[d] - margin[d], end = i[d] + margin[d] + 1;
          const int last_end = extents[d] > 0 ? low[d] + extents[d] : end;
          low[d]             = extents[d] > 0 ? std::min(low[d], begin) : begin;
          extents[d]         = std::max(last_end, end) - low[d];
        }
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
  /// another. Boxes of different levels have no common positions if their
  /// margins together are smaller than the gap between levels.
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
      for (const auto &pair : pairs)
        boxes[knots.level(pair.first[0])].include(pair.first, margin);
      begin.assign(1, 0);
      for (const LatticeBox &box : boxes)
        begin.push_back(begin.back() + box.size());
    }

    /// Collective. Return the smallest boxes around the boxes of all processes.
    LatticeBoxes
    of_all_processes(const NestedKnots &knots, const MPI_Comm comm) const
    {
      constexpr int    none = std::numeric_limits<int>::max();
      std::vector<int> bounds;
      for (const LatticeBox &box : boxes)
        for (unsigned int d = 0; d < 3; ++d)
          {
            const bool is_empty = box.extents[d] == 0;
            bounds.push_back(is_empty ? none : box.low[d]);
            bounds.push_back(is_empty ? none : 1 - box.low[d] - box.extents[d]);
          }
      dealii::Utilities::MPI::min(bounds, comm, bounds);
      std::vector<std::pair<Position, int>> corners;
      for (std::size_t k = 0; k < bounds.size(); k += 6)
        if (bounds[k] < none)
          {
            corners.push_back({{{bounds[k], bounds[k + 2], bounds[k + 4]}}, 0});
            corners.push_back(
              {{{-bounds[k + 1], -bounds[k + 3], -bounds[k + 5]}}, 0});
          }
      LatticeBoxes result;
      result.fit(knots, corners, {{0, 0, 0}});
      return result;
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

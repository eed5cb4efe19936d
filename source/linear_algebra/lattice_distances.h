// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <algorithm>
#include <array>
#include <vector>

/// Positions of unknowns in a lattice. To be included in sources.
namespace greville
{
  namespace internal
  {
    /// Compare positions in lexicographic order, x fastest.
    inline bool
    is_before(const std::array<int, 3> &a, const std::array<int, 3> &b)
    {
      return std::lexicographical_compare(a.rbegin(),
                                          a.rend(),
                                          b.rbegin(),
                                          b.rend());
    }



    /// Return the lattice distance of each unknown from the nearest one of the
    /// other kind, owned or ghost, but at most @p largest. Diagonal neighbors
    /// have the distance 1. @p order is lexicographic.
    inline std::vector<int>
    distances_to_other_part(const std::vector<std::array<int, 3>> &positions,
                            const std::vector<unsigned int>       &order,
                            const unsigned int                     n_owned,
                            const int                              largest)
    {
      const auto for_each_neighbor = [&](const unsigned int u,
                                         const auto        &visit) {
        for (int dz = -1; dz <= 1; ++dz)
          for (int dy = -1; dy <= 1; ++dy)
            {
              // Look at three neighbors in a row along x.
              std::array<int, 3> first = positions[u];
              first[0] -= 1;
              first[1] += dy;
              first[2] += dz;
              auto v =
                std::lower_bound(order.begin(),
                                 order.end(),
                                 first,
                                 [&](const unsigned int        w,
                                     const std::array<int, 3> &position) {
                                   return is_before(positions[w], position);
                                 });
              for (; v != order.end() && positions[*v][2] == first[2] &&
                     positions[*v][1] == first[1] &&
                     positions[*v][0] <= first[0] + 2;
                   ++v)
                visit(*v);
            }
      };
      std::vector<int>          distances(positions.size(), largest);
      std::vector<unsigned int> front, next;
      const auto set_distance = [&](const unsigned int u, const int distance) {
        if (distances[u] > distance)
          {
            distances[u] = distance;
            next.push_back(u);
          }
      };
      for (unsigned int g = n_owned; g < positions.size(); ++g)
        for_each_neighbor(g, [&](const unsigned int u) {
          if (u < n_owned)
            {
              set_distance(u, 1);
              set_distance(g, 1);
            }
        });
      for (int distance = 2; distance < largest; ++distance)
        {
          front.swap(next);
          next.clear();
          for (const unsigned int u : front)
            for_each_neighbor(u, [&](const unsigned int v) {
              if ((u < n_owned) == (v < n_owned))
                set_distance(v, distance);
            });
        }
      return distances;
    }
  } // namespace internal
} // namespace greville

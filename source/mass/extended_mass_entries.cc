// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/extended_mass.h>

#include <algorithm>
#include <numeric>

namespace greville
{
  using namespace dealii;

  template <int dim>
  LowerTriangle
  ExtendedMass<dim>::local_entries(const unsigned int components)
  {
    const unsigned int n = unknowns.size();
    LowerTriangle      result;

    // What all of them hold has no role here.
    std::vector<unsigned char>                is_held(n, 0);
    std::vector<std::pair<unsigned int, int>> held_roles;
    for (const auto &entry : held_places)
      if ((entry.second & components) == components)
        {
          int &role = roles[entry.first];
          held_roles.emplace_back(entry.first, role);
          if (role > 0)
            is_held[role - 1] = 1;
          role = 0;
        }

    // A row that is summed up, up to a column, and bits of its entries.
    constexpr unsigned int     n_bits = 64;
    std::vector<double>        sums(n, 0.);
    std::vector<std::uint64_t> touched(n / n_bits + 1, 0);
    unsigned int               lowest = n, highest = 0;
    const auto add_entry = [&](const unsigned int unknown, const double value) {
      if (is_held[unknown])
        return;
      touched[unknown / n_bits] |= std::uint64_t(1) << (unknown % n_bits);
      lowest  = std::min(lowest, unknown);
      highest = std::max(highest, unknown);
      sums[unknown] += value;
    };
    // Visit the entries, ascending, and clear the row.
    const auto take_row = [&](const auto &visit) {
      for (unsigned int word = lowest / n_bits;
           lowest <= highest && word <= highest / n_bits;
           ++word)
        for (; touched[word] != 0; touched[word] &= touched[word] - 1)
          {
            const unsigned int j =
              word * n_bits + __builtin_ctzll(touched[word]);
            visit(j, sums[j]);
            sums[j] = 0.;
          }
      lowest  = n;
      highest = 0;
    };
    const auto add_row_times_E = [&](const unsigned int place,
                                     const unsigned int last) {
      points_mass.for_each_entry(
        place, [&](const unsigned int j, const double value) {
          const int role = roles[j];
          if (role > 0)
            {
              if (unsigned(role - 1) <= last)
                add_entry(role - 1, value);
            }
          else if (role < 0)
            for (std::size_t e = extended_begin[-role - 1];
                 e < extended_begin[-role];
                 ++e)
              if (extended_entries[e].unknown <= last)
                add_entry(extended_entries[e].unknown,
                          extended_entries[e].weight * value);
        });
    };

    // B = M E in the rows of extended functions.
    std::vector<std::size_t> B_begin(1, 0);
    std::vector<Entry>       B;
    for (const unsigned int place : extended)
      {
        if (roles[place] != 0)
          add_row_times_E(place, n);
        take_row([&](const unsigned int j, const double value) {
          B.push_back({j, value});
        });
        B_begin.push_back(B.size());
      }

    // The extended functions of each unknown.
    std::vector<std::size_t> transpose_begin(n + 1, 0);
    for (const Entry &entry : extended_entries)
      ++transpose_begin[entry.unknown + 1];
    std::partial_sum(transpose_begin.begin(),
                     transpose_begin.end(),
                     transpose_begin.begin());
    std::vector<Entry> transpose(extended_entries.size());
    {
      auto next = transpose_begin;
      for (unsigned int k = 0; k < extended.size(); ++k)
        for (std::size_t e = extended_begin[k]; e < extended_begin[k + 1]; ++e)
          transpose[next[extended_entries[e].unknown]++] = {
            k, extended_entries[e].weight};
    }

    // Unknowns that no extended function meets have the entries of M.
    std::vector<bool> is_plain(n, true);
    for (unsigned int u = 0; u < n; ++u)
      is_plain[u] = transpose_begin[u] == transpose_begin[u + 1] && u < n_owned;
    for (const unsigned int place : extended)
      points_mass.for_each_entry(place,
                                 [&](const unsigned int j, const double) {
                                   if (roles[j] > 0)
                                     is_plain[roles[j] - 1] = false;
                                 });

    // A = (E^T B) with the rows of B = M E, lower part.
    const unsigned int length =
      2 * points_mass.space().degree() + 1; // of a stencil
    const std::size_t n_entries =
      std::size_t(n) * (Utilities::fixed_power<dim>(length) / 2 + 1);
    result.row_begin.reserve(n + 1);
    result.columns.reserve(n_entries);
    result.values.reserve(n_entries);
    for (unsigned int i = 0; i < n; ++i)
      {
        if (is_held[i])
          {
            const bool has_place = unknowns[i] != numbers::invalid_unsigned_int;
            result.columns.push_back(i);
            result.values.push_back(
              has_place ? points_mass.diagonal(unknowns[i]) : 0.);
            result.row_begin.push_back(result.columns.size());
            continue;
          }
        if (is_plain[i])
          {
            points_mass.for_each_lower_entry(
              unknowns[i], [&](const unsigned int j, const double value) {
                // Ghosts, which come last, have the entry in their row.
                if (roles[j] <= 0 || unsigned(roles[j] - 1) > i)
                  return;
                result.columns.push_back(roles[j] - 1);
                result.values.push_back(value);
              });
            // Where all its points are those of other processes.
            if (result.columns.size() == result.row_begin.back() ||
                result.columns.back() != i)
              {
                result.columns.push_back(i);
                result.values.push_back(0.);
              }
            result.row_begin.push_back(result.columns.size());
            continue;
          }
        if (unknowns[i] != numbers::invalid_unsigned_int)
          add_row_times_E(unknowns[i], i);
        for (std::size_t t = transpose_begin[i]; t < transpose_begin[i + 1];
             ++t)
          for (std::size_t b = B_begin[transpose[t].unknown];
               b < B_begin[transpose[t].unknown + 1];
               ++b)
            if (B[b].unknown <= i)
              add_entry(B[b].unknown, transpose[t].weight * B[b].weight);
        add_entry(i, 0.);
        take_row([&](const unsigned int j, const double value) {
          result.columns.push_back(j);
          result.values.push_back(value);
        });
        result.row_begin.push_back(result.columns.size());
      }
    for (const auto &entry : held_roles)
      roles[entry.first] = entry.second;
    return result;
  }



  template LowerTriangle
  ExtendedMass<2>::local_entries(const unsigned int);
  template LowerTriangle
  ExtendedMass<3>::local_entries(const unsigned int);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include "overlapping_domain.h"

#include "lattice_distances.h"
#include <cstring>
#include <numeric>

namespace greville
{
  using namespace dealii;

  namespace internal
  {
    namespace
    {
      using UnknownOf   = OverlappingDomain::UnknownOf;
      using DomainEntry = OverlappingDomain::DomainEntry;

      /// Collective. Send items to other processes, and return the received
      /// items.
      template <typename Item>
      std::vector<Item>
      send_and_receive(
        const std::map<unsigned int, std::vector<Item>> &messages,
        const MPI_Comm                                   comm)
      {
        // Send bytes: boost would serialize each item.
        static_assert(std::is_trivially_copyable<Item>::value, "");
        std::map<unsigned int, std::vector<char>> sent;
        for (const auto &[target, items] : messages)
          {
            const char *begin = reinterpret_cast<const char *>(items.data());
            sent[target].assign(begin, begin + items.size() * sizeof(Item));
          }
        std::vector<Item> result;
        for (const auto &[source, bytes] :
             Utilities::MPI::some_to_some(comm, sent))
          {
            const std::size_t n = result.size();
            result.resize(n + bytes.size() / sizeof(Item));
            std::memcpy(result.data() + n, bytes.data(), bytes.size());
          }
        return result;
      }



      void
      remove_duplicates(std::vector<UnknownOf> &unknowns)
      {
        std::sort(unknowns.begin(),
                  unknowns.end(),
                  [](const UnknownOf &a, const UnknownOf &b) {
                    return a.unknown < b.unknown;
                  });
        unknowns.erase(std::unique(unknowns.begin(),
                                   unknowns.end(),
                                   [](const UnknownOf &a, const UnknownOf &b) {
                                     return a.unknown == b.unknown;
                                   }),
                       unknowns.end());
      }



      /// Sort entries by rows, and return where each of the @p n rows begins.
      std::vector<unsigned int>
      sort_by_rows(std::vector<DomainEntry> &entries, const unsigned int n)
      {
        std::vector<unsigned int> begin(n + 1, 0);
        for (const DomainEntry &entry : entries)
          ++begin[entry.row + 1];
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        std::vector<DomainEntry>  sorted(entries.size());
        std::vector<unsigned int> next(begin);
        for (const DomainEntry &entry : entries)
          sorted[next[entry.row]++] = entry;
        entries.swap(sorted);
        return begin;
      }
    } // namespace



    OverlappingDomain::OverlappingDomain(
      const UpperTriangle         &matrix,
      const InterleavedLayout     &layout,
      const std::vector<Position> &own_positions,
      const unsigned int           n_layers,
      const RowVariants           &variants)
      : matrix(matrix)
      , layout(layout)
      , variants(variants)
      , comm(layout.communicator())
      , me(Utilities::MPI::this_mpi_process(comm))
      , n_owned(layout.n_owned())
      , positions(own_positions)
      , processes_of_row(n_owned)
      , differs(variants.differs.begin(),
                variants.differs.begin() +
                  (variants.differs.empty() ? 0 : n_owned))
      , fixed(variants.fixed)
    {
      differs.resize(n_owned, 0);
      fixed.resize(n_owned, 0);
      for (const auto &target : layout.partitioner(1)->ghost_targets())
        owners.insert(owners.end(), target.second, target.first);
      sum_shared_rows(matrix);
      find_ghosts(n_layers);
      received = send_and_receive(rows_for_others(matrix), comm);
      find_order();
    }



    UpperTriangle
    OverlappingDomain::domain_matrix(const unsigned int variant)
    {
      const UpperTriangle &own = variants.matrices[variant - 1];
      sum_shared_rows(own);
      received = send_and_receive(rows_for_others(own), comm);
      return domain_matrix(own);
    }



    UpperTriangle
    OverlappingDomain::last_rows(const UpperTriangle &all) const
    {
      const unsigned int first = n_common();
      UpperTriangle      result;
      for (unsigned int k = first; k < all.size(); ++k)
        {
          for (std::size_t e = all.row_begin[k]; e < all.row_begin[k + 1]; ++e)
            {
              result.columns.push_back(all.columns[e] - first);
              result.values.push_back(all.values[e]);
            }
          result.row_begin.push_back(result.columns.size());
        }
      return result;
    }



    std::vector<unsigned char>
    OverlappingDomain::is_fixed(const unsigned int variant) const
    {
      std::vector<unsigned char> result;
      for (unsigned int k = n_common(); k < order.size(); ++k)
        result.push_back((fixed[order[k]] >> variant) & 1);
      return result;
    }



    UpperTriangle
    OverlappingDomain::domain_matrix(const UpperTriangle &own) const
    {
      std::vector<DomainEntry> more;
      more.reserve(shared.size() + received.size());
      const auto add_local =
        [&](const unsigned int u, const unsigned int v, const double value) {
          const unsigned int i = row_of[u], j = row_of[v];
          more.push_back({std::min(i, j), std::max(i, j), value});
        };
      unsigned int last_row = n_owned, last_column = n_owned;
      const auto   add = [&](const SharedEntry &entry) {
        const unsigned int u = local(entry.row, last_row),
                           v = local(entry.column, last_column);
        if (v != numbers::invalid_unsigned_int)
          add_local(u, v, entry.value);
      };
      std::for_each(shared.begin(), shared.end(), add);
      for (const SharedEntry &entry : received)
        if (entry.row <= entry.column && !is_owned(entry.column))
          add(entry);
      if (n_common() < order.size())
        for (unsigned int i = 0; i < n_owned; ++i)
          for_each_entry(own, i, [&](const unsigned int j, const double value) {
            if (j < n_owned && differs[i] != differs[j])
              add_local(i, j, value);
          });
      const auto begin = sort_by_rows(more, order.size());

      UpperTriangle     result;
      const std::size_t n = own.columns.size() + more.size();
      result.columns.reserve(n);
      result.values.reserve(n);
      result.row_begin.reserve(order.size() + 1);
      for (unsigned int k = 0; k < order.size(); ++k)
        {
          append_own_entries(result, own, k);
          if (begin[k] < begin[k + 1])
            add_to_last_row(result, &more[begin[k]], &more[0] + begin[k + 1]);
          result.row_begin.push_back(result.columns.size());
        }
      return result;
    }



    void
    OverlappingDomain::append_own_entries(UpperTriangle       &result,
                                          const UpperTriangle &own,
                                          const unsigned int   row) const
    {
      if (order[row] < n_owned)
        for_each_entry(own,
                       order[row],
                       [&](const unsigned int j, const double value) {
                         if (j < n_owned && differs[j] == differs[order[row]])
                           {
                             result.columns.push_back(row_of[j]);
                             result.values.push_back(value);
                           }
                       });
    }



    void
    OverlappingDomain::add_to_last_row(UpperTriangle     &result,
                                       const DomainEntry *entry,
                                       const DomainEntry *end)
    {
      std::vector<std::pair<unsigned int, double>> row;
      for (; entry != end; ++entry)
        row.emplace_back(entry->column, entry->value);
      const std::size_t begin = result.row_begin.back();
      for (std::size_t e = begin; e < result.columns.size(); ++e)
        row.emplace_back(result.columns[e], result.values[e]);
      std::sort(row.begin(), row.end(), [](const auto &a, const auto &b) {
        return a.first < b.first;
      });
      result.columns.resize(begin);
      result.values.resize(begin);
      for (const auto &[column, value] : row)
        if (result.columns.size() > begin && result.columns.back() == column)
          result.values.back() += value;
        else
          {
            result.columns.push_back(column);
            result.values.push_back(value);
          }
    }



    void
    OverlappingDomain::sum_shared_rows(const UpperTriangle &own)
    {
      shared.clear();
      std::map<unsigned int, std::vector<SharedEntry>> messages;
      const auto                                       add =
        [&](const unsigned int i, const unsigned int j, const double value) {
          const SharedEntry entry{layout.global_number(i),
                                  layout.global_number(j),
                                  owner(j),
                                  value};
          if (i < n_owned)
            shared.push_back(entry);
          else
            messages[owner(i)].push_back(entry);
        };
      for (unsigned int i = 0; i < own.size(); ++i)
        for_each_entry(own, i, [&](const unsigned int j, const double value) {
          if (j < n_owned)
            return;
          add(i, j, value);
          if (owner(i) != owner(j))
            add(j, i, value);
        });
      const auto entries = send_and_receive(messages, comm);
      shared.insert(shared.end(), entries.begin(), entries.end());
    }



    void
    OverlappingDomain::find_ghosts(const unsigned int n_layers)
    {
      std::vector<UnknownOf> coupled;
      for (const SharedEntry &entry : shared)
        if (entry.owner_of_column != me)
          coupled.push_back({entry.column, entry.owner_of_column});
      for (unsigned int layer = 1; layer <= n_layers; ++layer)
        {
          add_ghosts(coupled);
          if (layer < n_layers)
            coupled = send_and_receive(columns_for_others(), comm);
        }
      for (const Ghost &ghost : all_ghosts)
        {
          positions.push_back(ghost.position);
          differs.push_back(ghost.differs);
          fixed.push_back(ghost.fixed);
        }
    }



    void
    OverlappingDomain::add_ghosts(std::vector<UnknownOf> &unknowns)
    {
      remove_duplicates(unknowns);
      std::map<unsigned int, std::vector<UnknownOf>> requests;
      for (const UnknownOf &item : unknowns)
        if (item.process != me && !is_ghost(item.unknown))
          requests[item.process].push_back({item.unknown, me});
      std::map<unsigned int, std::vector<Ghost>> answers;
      for (const UnknownOf &request : send_and_receive(requests, comm))
        {
          const unsigned int i = local(request.unknown);
          processes_of_row[i].push_back(request.process);
          answers[request.process].push_back(
            {request.unknown, positions[i], differs[i], fixed[i]});
        }
      const auto ghosts = send_and_receive(answers, comm);
      all_ghosts.insert(all_ghosts.end(), ghosts.begin(), ghosts.end());
      std::sort(all_ghosts.begin(),
                all_ghosts.end(),
                [](const Ghost &a, const Ghost &b) {
                  return a.unknown < b.unknown;
                });
      ghost_numbers.clear();
      for (const Ghost &ghost : all_ghosts)
        ghost_numbers.push_back(ghost.unknown);
    }



    std::map<unsigned int, std::vector<UnknownOf>>
    OverlappingDomain::columns_for_others() const
    {
      std::map<unsigned int, std::vector<UnknownOf>> messages;
      for (const SharedEntry &entry : shared)
        for (const unsigned int process : processes_of_row[local(entry.row)])
          if (process != entry.owner_of_column)
            messages[process].push_back({entry.column, entry.owner_of_column});
      const auto add = [&](const unsigned int i, const unsigned int j) {
        for (const unsigned int process : processes_of_row[i])
          messages[process].push_back({layout.global_number(j), me});
      };
      for (unsigned int i = 0; i < n_owned; ++i)
        for_each_entry(matrix, i, [&](const unsigned int j, const double) {
          if (j < n_owned && i != j)
            {
              add(i, j);
              add(j, i);
            }
        });
      for (auto &message : messages)
        remove_duplicates(message.second);
      return messages;
    }



    std::map<unsigned int, std::vector<OverlappingDomain::SharedEntry>>
    OverlappingDomain::rows_for_others(const UpperTriangle &own) const
    {
      std::map<unsigned int, std::vector<SharedEntry>> messages;
      const auto is_needed = [&](const unsigned int row,
                                 const unsigned int process) {
        const auto &processes = processes_of_row[row];
        return std::find(processes.begin(), processes.end(), process) !=
               processes.end();
      };
      const auto send = [&](const SharedEntry &entry) {
        for (const unsigned int process : processes_of_row[local(entry.row)])
          if (entry.owner_of_column == me
                ? is_needed(local(entry.column), process)
                : entry.owner_of_column != process)
            messages[process].push_back(entry);
      };
      std::for_each(shared.begin(), shared.end(), send);
      for (unsigned int i = 0; i < n_owned; ++i)
        if (!processes_of_row[i].empty())
          for_each_entry(own, i, [&](const unsigned int j, const double value) {
            if (j < n_owned)
              send(
                {layout.global_number(i), layout.global_number(j), me, value});
          });
      return messages;
    }



    void
    OverlappingDomain::find_order()
    {
      const unsigned int n = positions.size();
      lexicographic.resize(n);
      std::iota(lexicographic.begin(), lexicographic.end(), 0);
      const auto less = [&](const unsigned int u, const unsigned int v) {
        return internal::is_before(positions[u], positions[v]);
      };
      std::sort(lexicographic.begin() + n_owned, lexicographic.end(), less);
      std::inplace_merge(lexicographic.begin(),
                         lexicographic.begin() + n_owned,
                         lexicographic.end(),
                         less);
      order = lexicographic;
      std::stable_partition(order.begin(),
                            order.end(),
                            [&](const unsigned int u) { return !differs[u]; });
      row_of.resize(n);
      for (unsigned int k = 0; k < n; ++k)
        row_of[order[k]] = k;
    }



    bool
    OverlappingDomain::is_ghost(const Number unknown) const
    {
      return std::binary_search(ghost_numbers.begin(),
                                ghost_numbers.end(),
                                unknown);
    }



    unsigned int
    OverlappingDomain::local(const Number unknown, unsigned int &last) const
    {
      if (is_owned(unknown))
        return unknown - layout.global_number(0);
      const unsigned int n = ghost_numbers.size();
      for (unsigned int g = last - n_owned; g < last - n_owned + 2; ++g)
        if (g < n && ghost_numbers[g] == unknown)
          return last = n_owned + g;
      const auto found =
        std::lower_bound(ghost_numbers.begin(), ghost_numbers.end(), unknown);
      if (found == ghost_numbers.end() || *found != unknown)
        return numbers::invalid_unsigned_int;
      return last = n_owned + (found - ghost_numbers.begin());
    }
  } // namespace internal
} // namespace greville

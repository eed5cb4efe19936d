// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/linear_algebra/overlapping_cholesky.h>

#include "lattice_distances.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>

namespace greville
{
  using namespace dealii;

  namespace
  {
    using Number   = types::global_dof_index;
    using Position = std::array<int, 3>;

    /// A matrix entry with global numbers, and the process of its column.
    struct SharedEntry
    {
      Number       row, column;
      unsigned int owner_of_column;
      double       value;
    };

    /// An unknown, and a process: the one that owns it, or that needs its row.
    struct UnknownOf
    {
      Number       unknown;
      unsigned int process;
    };

    struct Ghost
    {
      Number   unknown;
      Position position;
    };

    /// Collective. Send items to other processes, and return all received ones.
    template <typename Item>
    std::vector<Item>
    send_and_receive(const std::map<unsigned int, std::vector<Item>> &messages,
                     const MPI_Comm                                   comm)
    {
      // As bytes, since boost would serialize item by item.
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



    /// An entry between rows of the domain.
    struct DomainEntry
    {
      unsigned int row, column;
      double       value;
    };

    /// Sort entries by rows, and return where the rows of @p n begin.
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



    /**
     * The domain of a process: its rows of A, and some layers of the unknowns
     * that A couples with them, in lexicographic order.
     */
    class OverlappingRows
    {
    public:
      /// Collective.
      OverlappingRows(const UpperTriangle         &matrix,
                      const InterleavedLayout     &layout,
                      const std::vector<Position> &own_positions,
                      const unsigned int           n_layers)
        : matrix(matrix)
        , layout(layout)
        , comm(layout.communicator())
        , me(Utilities::MPI::this_mpi_process(comm))
        , n_owned(layout.n_owned())
        , processes_of_row(n_owned)
        , positions(own_positions)
      {
        for (const auto &target : layout.partitioner(1)->ghost_targets())
          owners.insert(owners.end(), target.second, target.first);
        sum_shared_rows();
        find_ghosts(n_layers);
        received = send_and_receive(rows_for_others(), comm);
        find_order();
      }

      /// Return the unknowns of the overlap, ascending.
      const std::vector<Number> &
      ghosts() const
      {
        return ghost_numbers;
      }

      /// The local unknown of each row; and the positions of local unknowns.
      std::vector<unsigned int> order;

      const std::vector<Position> &
      domain_positions() const
      {
        return positions;
      }

      /// Return R A R^T.
      UpperTriangle
      domain_matrix() const
      {
        std::vector<DomainEntry> more;
        more.reserve(shared.size() + received.size());
        unsigned int last_row = n_owned, last_column = n_owned;
        const auto   add = [&](const SharedEntry &entry) {
          const unsigned int u = local(entry.row, last_row),
                             v = local(entry.column, last_column);
          if (v == numbers::invalid_unsigned_int)
            return;
          const unsigned int i = row_of[u], j = row_of[v];
          more.push_back({std::min(i, j), std::max(i, j), entry.value});
        };
        std::for_each(shared.begin(), shared.end(), add);
        for (const SharedEntry &entry : received)
          if (entry.row <= entry.column && !is_owned(entry.column))
            add(entry);
        const auto begin = sort_by_rows(more, order.size());

        UpperTriangle     result;
        const std::size_t n = matrix.columns.size() + more.size();
        result.columns.reserve(n);
        result.values.reserve(n);
        result.row_begin.reserve(order.size() + 1);
        for (unsigned int k = 0; k < order.size(); ++k)
          {
            append_own_entries(result, k);
            if (begin[k] < begin[k + 1])
              add_to_last_row(result, &more[begin[k]], &more[0] + begin[k + 1]);
            result.row_begin.push_back(result.columns.size());
          }
        return result;
      }

    private:
      /// Append the entries between owned unknowns. These keep their order, so
      /// that columns ascend.
      void
      append_own_entries(UpperTriangle &result, const unsigned int row) const
      {
        if (order[row] < n_owned)
          for_each_entry(order[row],
                         [&](const unsigned int j, const double value) {
                           if (j < n_owned)
                             {
                               result.columns.push_back(row_of[j]);
                               result.values.push_back(value);
                             }
                         });
      }

      static void
      add_to_last_row(UpperTriangle     &result,
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

      /// Call visit(j, A_ij) for the entries of this process in a row.
      template <typename Visit>
      void
      for_each_entry(const unsigned int i, const Visit &visit) const
      {
        for (std::size_t e = matrix.row_begin[i]; e < matrix.row_begin[i + 1];
             ++e)
          visit(matrix.columns[e], matrix.values[e]);
      }

      /**
       * Collective. Send the entries with unknowns of other processes there,
       * and keep those in own rows. Entries between unknowns of a process are
       * sent once.
       */
      void
      sum_shared_rows()
      {
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
        for (unsigned int i = 0; i < matrix.size(); ++i)
          for_each_entry(i, [&](const unsigned int j, const double value) {
            if (j < n_owned)
              return;
            add(i, j, value);
            if (owner(i) != owner(j))
              add(j, i, value);
          });
        const auto entries = send_and_receive(messages, comm);
        shared.insert(shared.end(), entries.begin(), entries.end());
      }

      /// Collective. Add layers of ghosts, and find who needs own rows.
      void
      find_ghosts(const unsigned int n_layers)
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
          positions.push_back(ghost.position);
      }

      /// Collective. Add those of the given unknowns that are not known yet.
      void
      add_ghosts(std::vector<UnknownOf> &unknowns)
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
            answers[request.process].push_back({request.unknown, positions[i]});
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

      /// Return the columns of own rows for the processes that need the rows.
      std::map<unsigned int, std::vector<UnknownOf>>
      columns_for_others() const
      {
        std::map<unsigned int, std::vector<UnknownOf>> messages;
        for (const SharedEntry &entry : shared)
          for (const unsigned int process : processes_of_row[local(entry.row)])
            if (process != entry.owner_of_column)
              messages[process].push_back(
                {entry.column, entry.owner_of_column});
        const auto add = [&](const unsigned int i, const unsigned int j) {
          for (const unsigned int process : processes_of_row[i])
            messages[process].push_back({layout.global_number(j), me});
        };
        for (unsigned int i = 0; i < n_owned; ++i)
          for_each_entry(i, [&](const unsigned int j, const double) {
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

      /**
       * Return the entries that processes need in addition to those that they
       * share: between own rows that they need, once, and in columns of others.
       */
      std::map<unsigned int, std::vector<SharedEntry>>
      rows_for_others() const
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
            for_each_entry(i, [&](const unsigned int j, const double value) {
              if (j < n_owned)
                send({layout.global_number(i),
                      layout.global_number(j),
                      me,
                      value});
            });
        return messages;
      }

      void
      find_order()
      {
        const unsigned int n = positions.size();
        order.resize(n);
        std::iota(order.begin(), order.end(), 0);
        const auto less = [&](const unsigned int u, const unsigned int v) {
          return internal::is_before(positions[u], positions[v]);
        };
        std::sort(order.begin() + n_owned, order.end(), less);
        std::inplace_merge(order.begin(),
                           order.begin() + n_owned,
                           order.end(),
                           less);
        row_of.resize(n);
        for (unsigned int k = 0; k < n; ++k)
          row_of[order[k]] = k;
      }

      unsigned int
      owner(const unsigned int unknown) const
      {
        return unknown < n_owned ? me : owners[unknown - n_owned];
      }

      bool
      is_owned(const Number unknown) const
      {
        return n_owned > 0 && unknown >= layout.global_number(0) &&
               unknown < layout.global_number(0) + n_owned;
      }

      bool
      is_ghost(const Number unknown) const
      {
        return std::binary_search(ghost_numbers.begin(),
                                  ghost_numbers.end(),
                                  unknown);
      }

      /**
       * Return the local number of an unknown, or invalid_unsigned_int. The
       * search begins behind the @p last ghost found, and updates it.
       */
      unsigned int
      local(const Number unknown, unsigned int &last) const
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

      unsigned int
      local(const Number unknown) const
      {
        unsigned int last = n_owned;
        return local(unknown, last);
      }

      const UpperTriangle      &matrix;
      const InterleavedLayout  &layout;
      const MPI_Comm            comm;
      const unsigned int        me, n_owned;
      std::vector<unsigned int> owners;   // of the ghosts of the layout
      std::vector<SharedEntry>  shared;   // in own rows
      std::vector<SharedEntry>  received; // in rows of the overlap
      std::vector<std::vector<unsigned int>> processes_of_row; // that need it
      std::vector<Ghost>                     all_ghosts;       // of the domain
      std::vector<Number>                    ghost_numbers;    // ascending
      std::vector<Position>                  positions; // of local unknowns
      std::vector<unsigned int>              row_of;    // of local unknowns
    };
  } // namespace



  void
  OverlappingCholesky::factorize(
    const UpperTriangle                            &matrix,
    const std::shared_ptr<const InterleavedLayout> &layout,
    const std::vector<std::array<int, 3>>          &positions,
    const int                                       reach,
    const unsigned int                              n_layers,
    const CholeskyParameters                       &parameters)
  {
    AssertThrow(matrix.size() == layout->n_local(),
                ExcDimensionMismatch(matrix.size(), layout->n_local()));
    AssertThrow(positions.size() == layout->n_owned(),
                ExcDimensionMismatch(positions.size(), layout->n_owned()));
    const MPI_Comm comm = layout->communicator();
    n_owned             = layout->n_owned();
    is_parallel         = Utilities::MPI::n_mpi_processes(comm) > 1;
    if (is_parallel)
      factorize_domain(matrix, *layout, positions, reach, n_layers, parameters);
    else
      factors.factorize(matrix, parameters);
  }



  void
  OverlappingCholesky::factorize_domain(
    const UpperTriangle                   &matrix,
    const InterleavedLayout               &layout,
    const std::vector<std::array<int, 3>> &positions,
    const int                              reach,
    const unsigned int                     n_layers,
    const CholeskyParameters              &parameters)
  {
    const MPI_Comm        comm = layout.communicator();
    const OverlappingRows overlapping(matrix, layout, positions, n_layers);
    order                             = overlapping.order;
    const UpperTriangle domain_matrix = overlapping.domain_matrix();
    run_on_all([&]() { factors.factorize(domain_matrix, parameters); }, comm);
    domain =
      InterleavedLayout(layout.n_owned() > 0 ? layout.global_number(0) : 0,
                        n_owned,
                        overlapping.ghosts(),
                        comm);
    for (auto &vector : doubles)
      vector.reinit(0);
    for (auto &vector : floats)
      vector.reinit(0);
    find_weights(overlapping.domain_positions(), reach * n_layers);
  }



  void
  OverlappingCholesky::find_weights(const std::vector<Position> &positions,
                                    const int                    reach)
  {
    // Ghosts have reach, ..., 1 with growing distance, owned unknowns have
    // more.
    const auto distances =
      internal::distances_to_other_part(positions, order, n_owned, reach);
    using Vector = LinearAlgebra::distributed::Vector<double>;
    Vector depth(domain.partitioner(1)), sum(domain.partitioner(1));
    for (unsigned int u = 0; u < order.size(); ++u)
      depth.local_element(u) =
        u < n_owned ? reach + distances[u] : reach + 1 - distances[u];
    for (unsigned int u = 0; u < order.size(); ++u)
      sum.local_element(u) = depth.local_element(u);
    sum.compress(VectorOperation::add);
    sum.update_ghost_values();
    weights.resize(order.size());
    for (unsigned int k = 0; k < order.size(); ++k)
      weights[k] =
        std::sqrt(depth.local_element(order[k]) / sum.local_element(order[k]));
  }



  void
  OverlappingCholesky::solve(double *x, const unsigned int width) const
  {
    if (is_parallel)
      solve(x, width, 1., doubles);
    else
      factors.solve(x, width);
  }



  void
  OverlappingCholesky::solve(float             *x,
                             const unsigned int width,
                             const double       unit) const
  {
    if (is_parallel)
      solve(x, width, unit, floats);
    else
      {
        factors.solve(x, width);
        const float factor = unit / factors.unit();
        for (std::size_t k = 0; k < std::size_t(n_owned) * width; ++k)
          x[k] *= factor;
      }
  }



  template <typename Number>
  void
  OverlappingCholesky::solve(Number            *x,
                             const unsigned int width,
                             const double       unit,
                             Vectors<Number>   &vectors) const
  {
    auto       &values      = vectors[width];
    const auto &partitioner = domain.partitioner(width);
    if (values.get_partitioner() != partitioner)
      values.reinit(partitioner);
    std::copy_n(x, n_owned * width, values.begin());
    values.update_ghost_values();
    double largest = 1.;
    if constexpr (std::is_same_v<Number, double>)
      {
        largest = 0.;
        for (unsigned int i = 0; i < order.size() * width; ++i)
          largest = std::max(largest, std::abs(values.local_element(i)));
      }
    const Number scale = largest > 0. ? 1. / largest : 0.;
    rows.resize(order.size() * width);
    for (unsigned int k = 0; k < order.size(); ++k)
      for (unsigned int c = 0; c < width; ++c)
        rows[k * width + c] =
          weights[k] * (scale * values.local_element(order[k] * width + c));
    factors.solve(rows.data(), width);
    values.zero_out_ghost_values();
    const Number unscale = largest * (unit / factors.unit());
    for (unsigned int k = 0; k < order.size(); ++k)
      for (unsigned int c = 0; c < width; ++c)
        values.local_element(order[k] * width + c) =
          unscale * weights[k] * rows[k * width + c];
    values.compress(VectorOperation::add);
    std::copy_n(values.begin(), n_owned * width, x);
  }
} // namespace greville

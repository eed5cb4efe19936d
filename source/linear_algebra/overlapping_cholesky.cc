// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/linear_algebra/overlapping_cholesky.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <set>

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

    struct SharedPosition
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



    /**
     * The domain of a process: its rows of A, and the rows of the unknowns that
     * A couples with them.
     */
    class OverlappingRows
    {
    public:
      OverlappingRows(const UpperTriangle     &matrix,
                      const InterleavedLayout &layout)
        : matrix(matrix)
        , layout(layout)
        , comm(layout.communicator())
        , me(Utilities::MPI::this_mpi_process(comm))
        , n_owned(layout.n_owned())
      {
        for (const auto &target : layout.partitioner(1)->ghost_targets())
          owners.insert(owners.end(), target.second, target.first);
        sum_shared_rows();
        for (const SharedEntry &entry : shared)
          if (entry.owner_of_column != me)
            all_ghosts.push_back(entry.column);
        std::sort(all_ghosts.begin(), all_ghosts.end());
        all_ghosts.erase(std::unique(all_ghosts.begin(), all_ghosts.end()),
                         all_ghosts.end());
      }

      /// Return the unknowns of the overlap, ascending.
      const std::vector<Number> &
      ghosts() const
      {
        return all_ghosts;
      }

      /// Collective. Return R A R^T, ghosts last.
      UpperTriangle
      domain_matrix() const
      {
        std::vector<std::vector<std::pair<unsigned int, double>>> more(
          n_owned + all_ghosts.size());
        const auto add =
          [&](const unsigned int i, const unsigned int j, const double value) {
            if (i <= j)
              more[i].emplace_back(j, value);
          };
        for (const SharedEntry &entry : shared)
          add(local(entry.row), local(entry.column), entry.value);
        for (const SharedEntry &entry :
             send_and_receive(rows_for_others(), comm))
          if (!is_owned(entry.column) && is_ghost(entry.column))
            add(local(entry.row), local(entry.column), entry.value);

        UpperTriangle result;
        for (unsigned int i = 0; i < more.size(); ++i)
          {
            if (i < n_owned)
              for_each_entry(i, [&](const unsigned int j, const double value) {
                if (j < n_owned)
                  more[i].emplace_back(j, value);
              });
            append_row(result, more[i]);
          }
        return result;
      }

      /// Collective. Return the positions of all unknowns of the domain.
      std::vector<Position>
      domain_positions(const std::vector<Position> &positions) const
      {
        std::map<unsigned int, std::vector<SharedPosition>> messages;
        for (const auto &[i, targets] : targets_of_rows())
          for (const unsigned int target : targets)
            messages[target].push_back({layout.global_number(i), positions[i]});
        std::vector<Position> result(positions);
        result.resize(n_owned + all_ghosts.size());
        for (const SharedPosition &item : send_and_receive(messages, comm))
          result[local(item.unknown)] = item.position;
        return result;
      }

    private:
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
       * Collective. Send the entries in rows of other processes there, and keep
       * those in own rows.
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
            if (i != j)
              add(j, i, value);
          });
        const auto received = send_and_receive(messages, comm);
        shared.insert(shared.end(), received.begin(), received.end());
      }

      /// Return the processes with columns in owned rows, by local row.
      std::map<unsigned int, std::set<unsigned int>>
      targets_of_rows() const
      {
        std::map<unsigned int, std::set<unsigned int>> result;
        for (const SharedEntry &entry : shared)
          if (entry.owner_of_column != me)
            result[local(entry.row)].insert(entry.owner_of_column);
        return result;
      }

      /**
       * Return the rows that other processes need, without entries below the
       * diagonal of the owned block.
       */
      std::map<unsigned int, std::vector<SharedEntry>>
      rows_for_others() const
      {
        std::map<unsigned int, std::vector<SharedEntry>> messages;
        const auto targets = targets_of_rows();
        const auto send    = [&](const SharedEntry &entry) {
          const auto row = targets.find(local(entry.row));
          if (row != targets.end())
            for (const unsigned int target : row->second)
              messages[target].push_back(entry);
        };
        std::for_each(shared.begin(), shared.end(), send);
        for (const auto &row : targets)
          for_each_entry(row.first,
                         [&](const unsigned int j, const double value) {
                           if (j < n_owned)
                             send({layout.global_number(row.first),
                                   layout.global_number(j),
                                   me,
                                   value});
                         });
        return messages;
      }

      unsigned int
      owner(const unsigned int unknown) const
      {
        return unknown < n_owned ? me : owners[unknown - n_owned];
      }

      bool
      is_owned(const Number unknown) const
      {
        const Number first = layout.global_number(0);
        return unknown >= first && unknown < first + n_owned;
      }

      bool
      is_ghost(const Number unknown) const
      {
        return std::binary_search(all_ghosts.begin(),
                                  all_ghosts.end(),
                                  unknown);
      }

      unsigned int
      local(const Number unknown) const
      {
        return is_owned(unknown)
                 ? unknown - layout.global_number(0)
                 : n_owned + (std::lower_bound(all_ghosts.begin(),
                                               all_ghosts.end(),
                                               unknown) -
                              all_ghosts.begin());
      }

      const UpperTriangle      &matrix;
      const InterleavedLayout  &layout;
      const MPI_Comm            comm;
      const unsigned int        me, n_owned;
      std::vector<unsigned int> owners;     // of the ghosts of the layout
      std::vector<SharedEntry>  shared;     // in own rows
      std::vector<Number>       all_ghosts; // of the domain
    };
  } // namespace



  void
  OverlappingCholesky::factorize(
    const UpperTriangle                            &matrix,
    const std::shared_ptr<const InterleavedLayout> &layout,
    const std::vector<std::array<int, 3>>          &positions,
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
      factorize_domain(matrix, *layout, positions, parameters);
    else
      factors.factorize(matrix, parameters);
  }



  void
  OverlappingCholesky::factorize_domain(
    const UpperTriangle                   &matrix,
    const InterleavedLayout               &layout,
    const std::vector<std::array<int, 3>> &positions,
    const CholeskyParameters              &parameters)
  {
    const MPI_Comm        comm = layout.communicator();
    const OverlappingRows overlapping(matrix, layout);
    const auto            all = overlapping.domain_positions(positions);
    order.resize(all.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(),
              order.end(),
              [&](const unsigned int u, const unsigned int v) {
                return std::lexicographical_compare(all[u].rbegin(),
                                                    all[u].rend(),
                                                    all[v].rbegin(),
                                                    all[v].rend());
              });
    const UpperTriangle ordered = reorder(overlapping.domain_matrix(), order);
    run_on_all([&]() { factors.factorize(ordered, parameters); }, comm);
    domain =
      InterleavedLayout(layout.n_owned() > 0 ? layout.global_number(0) : 0,
                        n_owned,
                        overlapping.ghosts(),
                        comm);
    for (Vector &vector : all_values)
      vector.reinit(0);
    find_weights();
  }



  void
  OverlappingCholesky::find_weights()
  {
    Vector n_domains(domain.partitioner(1));
    for (unsigned int u = 0; u < order.size(); ++u)
      n_domains.local_element(u) = 1.;
    n_domains.compress(VectorOperation::add);
    n_domains.update_ghost_values();
    weights.resize(order.size());
    for (unsigned int k = 0; k < order.size(); ++k)
      weights[k] = 1. / std::sqrt(n_domains.local_element(order[k]));
  }



  void
  OverlappingCholesky::solve(double *x, const unsigned int width) const
  {
    if (!is_parallel)
      {
        factors.solve(x, width);
        return;
      }
    Vector     &values      = all_values[width];
    const auto &partitioner = domain.partitioner(width);
    if (values.get_partitioner() != partitioner)
      values.reinit(partitioner);
    std::copy_n(x, n_owned * width, values.begin());
    values.update_ghost_values();
    double largest = 0.;
    for (unsigned int i = 0; i < order.size() * width; ++i)
      largest = std::max(largest, std::abs(values.local_element(i)));
    const double scale = largest > 0. ? 1. / largest : 0.;
    rows.resize(order.size() * width);
    for (unsigned int k = 0; k < order.size(); ++k)
      for (unsigned int c = 0; c < width; ++c)
        rows[k * width + c] =
          weights[k] * (scale * values.local_element(order[k] * width + c));
    factors.solve(rows.data(), width);
    values.zero_out_ghost_values();
    const double unscale = largest / factors.unit();
    for (unsigned int k = 0; k < order.size(); ++k)
      for (unsigned int c = 0; c < width; ++c)
        values.local_element(order[k] * width + c) =
          unscale * weights[k] * rows[k * width + c];
    values.compress(VectorOperation::add);
    std::copy_n(values.begin(), n_owned * width, x);
  }
} // namespace greville

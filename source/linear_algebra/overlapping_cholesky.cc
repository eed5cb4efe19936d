// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/linear_algebra/overlapping_cholesky.h>

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

    /// A process that needs the row of an unknown.
    struct Request
    {
      Number       unknown;
      unsigned int process;
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
     * The domain of a process: its rows of A, and some layers of the unknowns
     * that A couples with them.
     */
    class OverlappingRows
    {
    public:
      OverlappingRows(const UpperTriangle         &matrix,
                      const InterleavedLayout     &layout,
                      const std::vector<Position> &positions,
                      const unsigned int           n_layers)
        : matrix(matrix)
        , layout(layout)
        , comm(layout.communicator())
        , me(Utilities::MPI::this_mpi_process(comm))
        , n_owned(layout.n_owned())
      {
        for (const auto &target : layout.partitioner(1)->ghost_targets())
          owners.insert(owners.end(), target.second, target.first);
        sum_shared_rows();
        std::vector<SharedEntry> rows = shared;
        for (unsigned int layer = 0; layer < n_layers; ++layer)
          {
            rows = add_layer(rows, positions);
            received.insert(received.end(), rows.begin(), rows.end());
          }
        for (const auto &ghost : position_of)
          all_ghosts.push_back(ghost.first);
      }

      /// Return the unknowns of the overlap, ascending.
      const std::vector<Number> &
      ghosts() const
      {
        return all_ghosts;
      }

      /// Return R A R^T, ghosts last.
      UpperTriangle
      domain_matrix() const
      {
        std::vector<std::vector<std::pair<unsigned int, double>>> more(
          n_owned + all_ghosts.size());
        const auto add = [&](const SharedEntry &entry) {
          if (!is_owned(entry.column) && position_of.count(entry.column) == 0)
            return;
          const unsigned int i = local(entry.row), j = local(entry.column);
          if (i <= j)
            more[i].emplace_back(j, entry.value);
        };
        std::for_each(shared.begin(), shared.end(), add);
        std::for_each(received.begin(), received.end(), add);
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

      /// Return the positions of all unknowns of the domain.
      std::vector<Position>
      domain_positions(const std::vector<Position> &positions) const
      {
        std::vector<Position> result(positions);
        for (const auto &ghost : position_of)
          result.push_back(ghost.second);
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
        const auto entries = send_and_receive(messages, comm);
        shared.insert(shared.end(), entries.begin(), entries.end());
      }

      /**
       * Collective. Add the columns of @p rows to the ghosts, and return the
       * rows of the new ghosts.
       */
      std::vector<SharedEntry>
      add_layer(const std::vector<SharedEntry> &rows,
                const std::vector<Position>    &positions)
      {
        std::map<Number, unsigned int> new_ghosts; // and owners
        for (const SharedEntry &entry : rows)
          if (!is_owned(entry.column) && position_of.count(entry.column) == 0)
            new_ghosts[entry.column] = entry.owner_of_column;
        std::map<unsigned int, std::vector<Request>> requests;
        for (const auto &ghost : new_ghosts)
          requests[ghost.second].push_back({ghost.first, me});
        std::map<unsigned int, std::vector<unsigned int>>   processes; // by row
        std::map<unsigned int, std::vector<SharedPosition>> sent_positions;
        for (const Request &request : send_and_receive(requests, comm))
          {
            const unsigned int i = local(request.unknown);
            processes[i].push_back(request.process);
            sent_positions[request.process].push_back(
              {request.unknown, positions[i]});
          }
        for (const SharedPosition &ghost :
             send_and_receive(sent_positions, comm))
          position_of[ghost.unknown] = ghost.position;
        return send_and_receive(rows_for(processes), comm);
      }

      /// Return owned rows for the processes that need them.
      std::map<unsigned int, std::vector<SharedEntry>>
      rows_for(const std::map<unsigned int, std::vector<unsigned int>>
                 &processes) const
      {
        std::map<unsigned int, std::vector<SharedEntry>> messages;
        const auto send = [&](const SharedEntry &entry) {
          const auto row = processes.find(local(entry.row));
          if (row != processes.end())
            for (const unsigned int process : row->second)
              messages[process].push_back(entry);
        };
        std::for_each(shared.begin(), shared.end(), send);
        std::vector<bool> is_needed(n_owned, false);
        for (const auto &row : processes)
          is_needed[row.first] = true;
        for (unsigned int i = 0; i < n_owned; ++i)
          for_each_entry(i, [&](const unsigned int j, const double value) {
            if (j >= n_owned || !(is_needed[i] || is_needed[j]))
              return;
            const Number row    = layout.global_number(i),
                         column = layout.global_number(j);
            send({row, column, me, value});
            if (i != j)
              send({column, row, me, value});
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
        return n_owned > 0 && unknown >= layout.global_number(0) &&
               unknown < layout.global_number(0) + n_owned;
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

      const UpperTriangle       &matrix;
      const InterleavedLayout   &layout;
      const MPI_Comm             comm;
      const unsigned int         me, n_owned;
      std::vector<unsigned int>  owners;      // of the ghosts of the layout
      std::vector<SharedEntry>   shared;      // in own rows
      std::vector<SharedEntry>   received;    // in rows of the overlap
      std::map<Number, Position> position_of; // unknowns of the overlap
      std::vector<Number>        all_ghosts;  // of the domain
    };



    /**
     * Return the distance of each unknown from the nearest one of the other
     * kind, owned or ghost, in a lattice whose diagonal neighbors have distance
     * 1; @p largest if it is larger.
     */
    std::vector<int>
    distances_to_other_part(const std::vector<Position> &positions,
                            const unsigned int           n_owned,
                            const int                    largest)
    {
      const unsigned int        n = positions.size();
      std::vector<unsigned int> sorted(n);
      std::iota(sorted.begin(), sorted.end(), 0);
      std::sort(sorted.begin(),
                sorted.end(),
                [&](const unsigned int u, const unsigned int v) {
                  return positions[u] < positions[v];
                });
      const auto for_each_neighbor = [&](const unsigned int u,
                                         const auto        &visit) {
        for (int dx = -1; dx <= 1; ++dx)
          for (int dy = -1; dy <= 1; ++dy)
            {
              // Three neighbors in a row of the sorted positions.
              Position first = positions[u];
              first[0] += dx;
              first[1] += dy;
              first[2] -= 1;
              auto v = std::lower_bound(sorted.begin(),
                                        sorted.end(),
                                        first,
                                        [&](const unsigned int w,
                                            const Position    &position) {
                                          return positions[w] < position;
                                        });
              for (; v != sorted.end() && positions[*v][0] == first[0] &&
                     positions[*v][1] == first[1] &&
                     positions[*v][2] <= first[2] + 2;
                   ++v)
                visit(*v);
            }
      };
      std::vector<int>          distances(n, largest);
      std::vector<unsigned int> front, next;
      const auto set_distance = [&](const unsigned int u, const int distance) {
        if (distances[u] > distance)
          {
            distances[u] = distance;
            next.push_back(u);
          }
      };
      for (unsigned int g = n_owned; g < n; ++g)
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
    find_weights(all, reach * n_layers);
  }



  void
  OverlappingCholesky::find_weights(const std::vector<Position> &positions,
                                    const int                    reach)
  {
    // Ghosts have reach, ..., 1 with growing distance, owned unknowns have
    // more.
    const auto distances = distances_to_other_part(positions, n_owned, reach);
    Vector     depth(domain.partitioner(1)), sum(domain.partitioner(1));
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

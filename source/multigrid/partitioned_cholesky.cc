#include <greville/base/errors.h>
#include <greville/multigrid/partitioned_cholesky.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * The rows and columns of a matrix in another order.
     */
    LowerTriangle
    reorder(const LowerTriangle &matrix, const std::vector<unsigned int> &order)
    {
      const unsigned int        n = matrix.size();
      std::vector<unsigned int> row_of(n);
      for (unsigned int k = 0; k < n; ++k)
        row_of[order[k]] = k;

      // By columns, and from there by rows: columns ascend.
      const std::size_t         n_entries = matrix.columns.size();
      std::vector<std::size_t>  column_begin(n + 1, 0), next(n + 1, 0);
      std::vector<unsigned int> rows(n_entries);
      std::vector<double>       values(n_entries);
      const auto                for_each = [&](const auto &visit) {
        for (unsigned int i = 0; i < n; ++i)
          for (std::size_t e = matrix.row_begin[i]; e < matrix.row_begin[i + 1];
               ++e)
            {
              const unsigned int a = row_of[i], b = row_of[matrix.columns[e]];
              visit(std::max(a, b), std::min(a, b), e);
            }
      };
      LowerTriangle result;
      result.row_begin.assign(n + 1, 0);
      for_each([&](const unsigned int row,
                   const unsigned int column,
                   const std::size_t) {
        ++column_begin[column + 1];
        ++result.row_begin[row + 1];
      });
      std::partial_sum(column_begin.begin(),
                       column_begin.end(),
                       column_begin.begin());
      std::partial_sum(result.row_begin.begin(),
                       result.row_begin.end(),
                       result.row_begin.begin());
      next = column_begin;
      for_each([&](const unsigned int row,
                   const unsigned int column,
                   const std::size_t  e) {
        rows[next[column]]     = row;
        values[next[column]++] = matrix.values[e];
      });
      next = result.row_begin;
      result.columns.resize(n_entries);
      result.values.resize(n_entries);
      for (unsigned int column = 0; column < n; ++column)
        for (std::size_t e = column_begin[column]; e < column_begin[column + 1];
             ++e)
          {
            result.columns[next[rows[e]]]  = column;
            result.values[next[rows[e]]++] = values[e];
          }
      return result;
    }



    /**
     * An entry of the Schur complement, by global numbers.
     */
    struct Entry
    {
      types::global_dof_index row, column;
      double                  value;

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &row &column &value;
      }
    };
  } // namespace



  void
  PartitionedCholesky::factorize(
    const LowerTriangle                            &matrix,
    const std::shared_ptr<const InterleavedLayout> &new_layout,
    const std::vector<std::array<unsigned int, 3>> &positions,
    const std::vector<bool>                        &may_leave_out,
    const double                                    shift)
  {
    layout = new_layout;
    for (Vector &vector : at_interface)
      vector.reinit(0);
    AssertDimension(matrix.size(), layout->n_local());
    find_interface();
    find_order(positions, may_leave_out);
    held_interior.rows.clear();
    held_interface.rows.clear();

    LowerTriangle rest;
    run_on_all(
      [&]() {
        if (std::is_sorted(order.begin(), order.end()))
          interior.factorize(matrix, shift, n_interior, rest);
        else
          interior.factorize(reorder(matrix, order), shift, n_interior, rest);
      },
      layout->communicator());
    if (!is_parallel())
      return;
    const LowerTriangle sum = sum_of_complements(rest);
    run_on_all([&]() { interface.factorize(sum, shift); },
               layout->communicator());
  }



  void
  PartitionedCholesky::find_interface()
  {
    const MPI_Comm comm = layout->communicator();
    interface_unknowns.clear();
    if (!is_parallel())
      {
        interface_layout = std::make_unique<InterleavedLayout>(
          0, 0, std::vector<types::global_dof_index>(), comm);
        return;
      }
    const unsigned int n_owned = layout->n_owned(), n = layout->n_local();
    std::vector<bool>  is_shared(n, false);
    std::fill(is_shared.begin() + n_owned, is_shared.end(), true);
    for (const auto &range : layout->partitioner(1)->import_indices())
      std::fill(is_shared.begin() + range.first,
                is_shared.begin() + range.second,
                true);

    // The first process that knows an unknown manages it.
    const double me = Utilities::MPI::this_mpi_process(comm);
    Vector       manager(layout->partitioner(1));
    for (unsigned int u = 0; u < n; ++u)
      manager.local_element(u) = me;
    manager.compress(VectorOperation::min);
    manager.update_ghost_values();
    std::uint64_t n_managed = 0;
    for (const bool managed : {true, false})
      for (unsigned int u = 0; u < n; ++u)
        if (is_shared[u] && (manager.local_element(u) == me) == managed)
          {
            interface_unknowns.push_back(u);
            n_managed += managed;
          }

    std::uint64_t first = 0;
    int ierr = MPI_Exscan(&n_managed, &first, 1, MPI_UINT64_T, MPI_SUM, comm);
    AssertThrowMPI(ierr);
    if (me == 0)
      first = 0;
    Vector number(layout->partitioner(1));
    for (unsigned int u = 0; u < n; ++u)
      number.local_element(u) = -1.;
    for (unsigned int k = 0; k < n_managed; ++k)
      number.local_element(interface_unknowns[k]) = first + k;
    number.compress(VectorOperation::max);
    number.update_ghost_values();
    const auto number_of = [&](const unsigned int u) {
      return types::global_dof_index(number.local_element(u));
    };
    std::sort(interface_unknowns.begin() + n_managed,
              interface_unknowns.end(),
              [&](const unsigned int u, const unsigned int v) {
                return number_of(u) < number_of(v);
              });
    std::vector<types::global_dof_index> ghosts;
    for (unsigned int k = n_managed; k < interface_unknowns.size(); ++k)
      ghosts.push_back(number_of(interface_unknowns[k]));
    interface_layout =
      std::make_unique<InterleavedLayout>(first, n_managed, ghosts, comm);
  }



  void
  PartitionedCholesky::find_order(
    const std::vector<std::array<unsigned int, 3>> &positions,
    const std::vector<bool>                        &may_leave_out)
  {
    const unsigned int n_owned = layout->n_owned(), n = layout->n_local();
    AssertDimension(positions.size(), n_owned);
    AssertDimension(may_leave_out.size(), n_owned);
    std::vector<bool> is_interior(n, true);
    for (const unsigned int u : interface_unknowns)
      is_interior[u] = false;
    n_interior = n - interface_unknowns.size();

    // Where on the average are those that come last?
    std::array<double, 3>       mean{}, mean_last{};
    std::array<unsigned int, 3> largest{};
    unsigned int                n_last = 0;
    for (unsigned int u = 0; u < n_owned; ++u)
      {
        const bool is_last = !is_interior[u] || may_leave_out[u];
        n_last += is_last;
        for (unsigned int d = 0; d < 3; ++d)
          {
            mean[d] += double(positions[u][d]) / n_owned;
            largest[d] = std::max(largest[d], positions[u][d]);
            if (is_last)
              mean_last[d] += positions[u][d];
          }
      }
    std::array<bool, 3> descends;
    for (unsigned int d = 0; d < 3; ++d)
      descends[d] = n_last > 0 && mean_last[d] < (mean[d] - 0.5) * n_last;

    std::vector<std::pair<std::uint64_t, unsigned int>> sequence;
    for (unsigned int u = 0; u < n_owned; ++u)
      if (is_interior[u])
        {
          std::uint64_t key = 0;
          for (unsigned int d = 3; d-- > 0;)
            key =
              key * (std::uint64_t(largest[d]) + 1) +
              (descends[d] ? largest[d] - positions[u][d] : positions[u][d]);
          sequence.emplace_back(key, u);
        }
    if (!std::is_sorted(sequence.begin(), sequence.end()))
      std::sort(sequence.begin(), sequence.end());
    order.clear();
    for (const auto &entry : sequence)
      order.push_back(entry.second);
    order.insert(order.end(),
                 interface_unknowns.begin(),
                 interface_unknowns.end());
  }



  LowerTriangle
  PartitionedCholesky::sum_of_complements(const LowerTriangle &own) const
  {
    const unsigned int n_managed = interface_layout->n_owned();
    std::vector<std::vector<std::pair<unsigned int, double>>> rows(n_managed);
    const auto                                                add =
      [&](const unsigned int i, const unsigned int j, const double value) {
        rows[std::max(i, j)].emplace_back(std::min(i, j), value);
      };

    // Managers of what others manage.
    std::vector<unsigned int> manager(n_managed, numbers::invalid_unsigned_int);
    for (const auto &target : interface_layout->partitioner(1)->ghost_targets())
      manager.insert(manager.end(), target.second, target.first);
    std::map<unsigned int, std::vector<Entry>> to_send;
    for (unsigned int i = 0; i < own.size(); ++i)
      for (std::size_t e = own.row_begin[i]; e < own.row_begin[i + 1]; ++e)
        {
          const unsigned int j = own.columns[e];
          if (manager[i] != manager[j])
            continue;
          if (i < n_managed)
            add(i, j, own.values[e]);
          else
            to_send[manager[i]].push_back({interface_layout->global_number(i),
                                           interface_layout->global_number(j),
                                           own.values[e]});
        }
    const auto received =
      Utilities::MPI::some_to_some(layout->communicator(), to_send);
    const auto first = interface_layout->global_number(0);
    for (const auto &message : received)
      for (const Entry &entry : message.second)
        add(entry.row - first, entry.column - first, entry.value);

    LowerTriangle result;
    for (auto &row : rows)
      {
        std::sort(row.begin(), row.end(), [](const auto &a, const auto &b) {
          return a.first < b.first;
        });
        for (std::size_t k = 0; k < row.size(); ++k)
          if (k > 0 && row[k].first == row[k - 1].first)
            result.values.back() += row[k].second;
          else
            {
              result.columns.push_back(row[k].first);
              result.values.push_back(row[k].second);
            }
        result.row_begin.push_back(result.columns.size());
      }
    return result;
  }



  void
  PartitionedCholesky::hold(const std::vector<unsigned char> &held,
                            const unsigned int                n_components)
  {
    AssertDimension(held.size(), layout->n_owned());
    held_interior.n_components  = n_components;
    held_interface.n_components = n_components;
    held_interior.rows.clear();
    held_interface.rows.clear();
    for (unsigned int k = 0; k < n_interior; ++k)
      if (held[order[k]] != 0)
        held_interior.rows.emplace_back(k, held[order[k]]);
    if (!is_parallel())
      return;
    // Managers need not own what they manage.
    Vector &bits = vector_at_interface(1);
    for (unsigned int k = 0; k < interface_unknowns.size(); ++k)
      bits.local_element(k) =
        interface_unknowns[k] < held.size() ? held[interface_unknowns[k]] : 0.;
    bits.compress(VectorOperation::add);
    for (unsigned int k = 0; k < interface_layout->n_owned(); ++k)
      if (bits.local_element(k) != 0.)
        held_interface.rows.emplace_back(
          k, static_cast<unsigned char>(bits.local_element(k)));
  }



  PartitionedCholesky::Vector &
  PartitionedCholesky::vector_at_interface(const unsigned int width) const
  {
    Vector     &result      = at_interface[width];
    const auto &partitioner = interface_layout->partitioner(width);
    if (result.get_partitioner() != partitioner)
      result.reinit(partitioner);
    return result;
  }



  void
  PartitionedCholesky::solve(double *x, const unsigned int width) const
  {
    const unsigned int n_owned = layout->n_owned();
    values.resize(std::size_t(layout->n_local()) * width);

    // In single precision, of numbers of the size 1.
    double largest = 0.;
    for (std::size_t k = 0; k < std::size_t(n_owned) * width; ++k)
      largest = std::max(largest, std::abs(x[k]));
    if (!is_parallel() && !(largest > 0.))
      return;
    const double scale = largest > 0. ? 1. / largest : 0.;
    for (unsigned int k = 0; k < n_interior; ++k)
      for (unsigned int c = 0; c < width; ++c)
        values[std::size_t(k) * width + c] =
          scale * x[std::size_t(order[k]) * width + c];
    std::fill(values.begin() + std::size_t(n_interior) * width,
              values.end(),
              0.f);
    interior.forward(values.data(), width, held_interior);
    if (is_parallel())
      solve_interface(x, width, largest);
    interior.backward(values.data(), width, held_interior);
    const double back = (largest > 0. ? largest : 1.) / interior.unit();
    for (unsigned int k = 0; k < n_interior; ++k)
      for (unsigned int c = 0; c < width; ++c)
        x[std::size_t(order[k]) * width + c] =
          back * values[std::size_t(k) * width + c];
  }



  void
  PartitionedCholesky::solve_interface(double            *x,
                                       const unsigned int width,
                                       const double       largest) const
  {
    // What the interior leaves, from all processes.
    const unsigned int n_owned = layout->n_owned();
    Vector            &y       = vector_at_interface(width);
    float             *rest = values.data() + std::size_t(n_interior) * width;
    for (unsigned int k = 0; k < interface_unknowns.size(); ++k)
      for (unsigned int c = 0; c < width; ++c)
        {
          const std::size_t i = std::size_t(k) * width + c;
          y.local_element(i)  = largest * rest[i];
          if (interface_unknowns[k] < n_owned)
            y.local_element(i) +=
              x[std::size_t(interface_unknowns[k]) * width + c];
        }
    y.compress(VectorOperation::add);
    interface.solve(y.begin(), width, held_interface);
    y.update_ghost_values();
    const double scale = interior.unit() / (largest > 0. ? largest : 1.);
    for (unsigned int k = 0; k < interface_unknowns.size(); ++k)
      for (unsigned int c = 0; c < width; ++c)
        {
          const std::size_t i = std::size_t(k) * width + c;
          rest[i]             = scale * y.local_element(i);
          if (interface_unknowns[k] < n_owned)
            x[std::size_t(interface_unknowns[k]) * width + c] =
              y.local_element(i);
        }
    y.zero_out_ghost_values();
  }



  std::size_t
  PartitionedCholesky::memory_consumption() const
  {
    std::size_t n =
      interior.memory_consumption() + interface.memory_consumption() +
      (order.size() + interface_unknowns.size()) * sizeof(unsigned int) +
      values.size() * sizeof(float);
    for (const Vector &vector : at_interface)
      n += vector.memory_consumption();
    return n;
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/index_limits.h>
#include <greville/linear_algebra/partitioned_cholesky.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    using Position = std::array<int, 3>;

    /**
     * Return whether any of the next @p n positions in a direction is among the
     * given, sorted ones.
     */
    bool
    is_followed(Position                     x,
                const unsigned int           direction,
                const int                    step,
                const unsigned int           n,
                const std::vector<Position> &sorted)
    {
      for (unsigned int k = 0; k < n; ++k)
        {
          x[direction] += step;
          if (std::binary_search(sorted.begin(), sorted.end(), x))
            return true;
        }
      return false;
    }



    /// An entry of the Schur complement, in global numbers.
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
    const std::vector<std::array<int, 3>>          &positions,
    const std::vector<bool>                        &may_leave_out,
    const unsigned int                              reach,
    const double                                    shift)
  {
    // Complements miss the fill that IC(0) drops, and need not be positive.
    constexpr double       smallest_shift = 1e-3;
    constexpr unsigned int most_tries     = 12;
    double                 tried_shift    = shift;
    for (unsigned int k = 0; k < most_tries; ++k)
      {
        if (try_shift(
              matrix, new_layout, positions, may_leave_out, reach, tried_shift))
          return;
        tried_shift = std::max(2. * tried_shift, smallest_shift);
      }
    throw_on_all("IC(0) finds no positive complement of the unknowns that "
                 "processes share, with shifts up to " +
                   text_of(0.5 * tried_shift) + ".",
                 layout->communicator());
  }



  bool
  PartitionedCholesky::try_shift(
    const LowerTriangle                            &matrix,
    const std::shared_ptr<const InterleavedLayout> &new_layout,
    std::vector<std::array<int, 3>>                 positions,
    std::vector<bool>                               may_leave_out,
    const unsigned int                              reach,
    const double                                    shift)
  {
    layout = new_layout;
    for (Vector &vector : at_interface)
      vector.reinit(0);
    AssertThrow(matrix.size() == layout->n_local(),
                ExcDimensionMismatch(matrix.size(), layout->n_local()));
    AssertThrow(positions.size() == layout->n_owned(),
                ExcDimensionMismatch(positions.size(), layout->n_owned()));
    AssertThrow(may_leave_out.size() == layout->n_owned(),
                ExcDimensionMismatch(may_leave_out.size(), layout->n_owned()));
    add_ghosts(positions, may_leave_out);
    find_interface();
    find_order(positions, may_leave_out, reach);
    constrained_interior.rows.clear();

    const bool has_interface =
      Utilities::MPI::max<unsigned int>(interface_unknowns.size(),
                                        layout->communicator()) > 0;
    LowerTriangle ordered, rest;
    const bool    is_ordered = std::is_sorted(order.begin(), order.end());
    if (!is_ordered)
      ordered = reorder(matrix, order);
    if (has_fill)
      ordered = with_fill(is_ordered ? matrix : ordered, n_interior);
    run_on_all(
      [&]() {
        interior.factorize(has_fill || !is_ordered ? ordered : matrix,
                           shift,
                           n_interior,
                           rest);
      },
      layout->communicator());
    next.reset();
    return !has_interface ||
           make_next_level(rest, positions, may_leave_out, reach, shift);
  }



  void
  PartitionedCholesky::add_ghosts(std::vector<std::array<int, 3>> &positions,
                                  std::vector<bool> &may_leave_out) const
  {
    if (!is_parallel())
      return;
    constexpr unsigned int width = 4;
    Vector                 all(layout->partitioner(width));
    for (unsigned int u = 0; u < positions.size(); ++u)
      {
        for (unsigned int d = 0; d < 3; ++d)
          all.local_element(u * width + d) = positions[u][d];
        all.local_element(u * width + 3) = may_leave_out[u];
      }
    all.update_ghost_values();
    for (unsigned int u = positions.size(); u < layout->n_local(); ++u)
      {
        std::array<int, 3> x;
        for (unsigned int d = 0; d < 3; ++d)
          x[d] = static_cast<int>(all.local_element(u * width + d));
        positions.push_back(x);
        may_leave_out.push_back(all.local_element(u * width + 3) != 0.);
      }
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

    // The first process that stores an unknown manages it.
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

    const std::uint64_t first = sum_before(n_managed, comm);
    Vector              number(layout->partitioner(1));
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
    const std::vector<std::array<int, 3>> &positions,
    const std::vector<bool>               &may_leave_out,
    const unsigned int                     reach)
  {
    const unsigned int n = layout->n_local();
    std::vector<bool>  is_interior(n, true);
    for (const unsigned int u : interface_unknowns)
      is_interior[u] = false;
    n_interior = n - interface_unknowns.size();

    // Find the sides on which the last unknowns lie.
    std::vector<Position> first;
    for (unsigned int u = 0; u < n; ++u)
      if (is_interior[u] && !may_leave_out[u])
        first.push_back(positions[u]);
    std::sort(first.begin(), first.end());
    std::array<int, 3> balance{}, largest{};
    for (unsigned int u = 0; u < n; ++u)
      for (unsigned int d = 0; d < 3; ++d)
        {
          largest[d] = std::max(largest[d], positions[u][d]);
          if (!is_interior[u] || may_leave_out[u])
            balance[d] += is_followed(positions[u], d, -1, reach, first) -
                          is_followed(positions[u], d, 1, reach, first);
        }
    for (unsigned int d = 0; d < 3; ++d)
      descends[d] = balance[d] < 0;

    std::vector<std::pair<std::uint64_t, unsigned int>> sequence;
    for (unsigned int u = 0; u < n; ++u)
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



  bool
  PartitionedCholesky::make_next_level(
    const LowerTriangle                   &complement,
    const std::vector<std::array<int, 3>> &positions,
    const std::vector<bool>               &may_leave_out,
    const unsigned int                     reach,
    const double                           shift)
  {
    const MPI_Comm     comm      = layout->communicator();
    const unsigned int me        = Utilities::MPI::this_mpi_process(comm);
    const unsigned int n_managed = interface_layout->n_owned();

    std::vector<std::array<int, 3>> next_positions;
    std::vector<bool>               next_may_leave_out;
    for (unsigned int k = 0; k < n_managed; ++k)
      {
        next_positions.push_back(positions[interface_unknowns[k]]);
        next_may_leave_out.push_back(may_leave_out[interface_unknowns[k]]);
      }

    // An entry belongs to the first of its managers.
    std::vector<unsigned int> manager(n_managed, me);
    for (const auto &target : interface_layout->partitioner(1)->ghost_targets())
      manager.insert(manager.end(), target.second, target.first);
    std::map<unsigned int, std::vector<Entry>> sent;
    for (unsigned int i = 0; i < complement.size(); ++i)
      for (std::size_t e = complement.row_begin[i];
           e < complement.row_begin[i + 1];
           ++e)
        {
          const unsigned int j = complement.columns[e];
          sent[std::min(manager[i], manager[j])].push_back(
            {interface_layout->global_number(i),
             interface_layout->global_number(j),
             complement.values[e]});
        }
    auto       received = exchange_lists(comm, sent);
    const auto own      = sent.find(me);
    if (own != sent.end())
      received[me] = std::move(own->second);

    const auto first =
      interface_layout->n_owned() > 0 ? interface_layout->global_number(0) : 0;
    const auto is_own = [&](const types::global_dof_index i) {
      return i >= first && i < first + n_managed;
    };
    std::vector<types::global_dof_index> ghosts;
    for (const auto &message : received)
      for (const Entry &entry : message.second)
        for (const auto i : {entry.row, entry.column})
          if (!is_own(i))
            ghosts.push_back(i);
    std::sort(ghosts.begin(), ghosts.end());
    ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
    const auto local = [&](const types::global_dof_index i) -> unsigned int {
      return is_own(i) ? i - first
                       : n_managed +
                           (std::lower_bound(ghosts.begin(), ghosts.end(), i) -
                            ghosts.begin());
    };

    std::vector<std::vector<std::pair<unsigned int, double>>> rows(
      n_managed + ghosts.size());
    for (unsigned int i = 0; i < rows.size(); ++i)
      rows[i].emplace_back(i, 0.);
    for (const auto &message : received)
      for (const Entry &entry : message.second)
        {
          const unsigned int i = local(entry.row), j = local(entry.column);
          rows[std::max(i, j)].emplace_back(std::min(i, j), entry.value);
        }
    const LowerTriangle sum         = sum_entries(rows);
    bool                is_negative = false;
    for (unsigned int i = 0; i < n_managed; ++i)
      is_negative = is_negative || !(sum.values[sum.row_begin[i + 1] - 1] > 0.);
    if (Utilities::MPI::max<unsigned int>(is_negative, comm) > 0)
      return false;
    next           = std::make_unique<PartitionedCholesky>();
    next->has_fill = true;
    return next->try_shift(
      sum,
      std::make_shared<InterleavedLayout>(first, n_managed, ghosts, comm),
      next_positions,
      next_may_leave_out,
      reach,
      shift);
  }



  void
  PartitionedCholesky::constrain(const std::vector<unsigned char> &constrained,
                                 const unsigned int                n_components)
  {
    AssertThrow(constrained.size() == layout->n_owned(),
                ExcDimensionMismatch(constrained.size(), layout->n_owned()));
    constrained_interior.n_components = n_components;
    constrained_interior.rows.clear();
    for (unsigned int k = 0; k < n_interior; ++k)
      if (constrained[order[k]] != 0)
        constrained_interior.rows.emplace_back(k, constrained[order[k]]);
    if (!next)
      return;
    // Managers need not own the unknowns that they manage.
    Vector &bits = vector_at_interface(1);
    for (unsigned int k = 0; k < interface_unknowns.size(); ++k)
      bits.local_element(k) = interface_unknowns[k] < constrained.size()
                                ? constrained[interface_unknowns[k]]
                                : 0.;
    bits.compress(VectorOperation::add);
    std::vector<unsigned char> next_constrained;
    for (unsigned int k = 0; k < interface_layout->n_owned(); ++k)
      next_constrained.push_back(
        static_cast<unsigned char>(bits.local_element(k)));
    next->constrain(next_constrained, n_components);
  }



  void
  PartitionedCholesky::solve(double *x, const unsigned int width) const
  {
    const unsigned int n_owned = layout->n_owned();
    values.resize(std::size_t(layout->n_local()) * width);

    // Solve in single precision, with numbers of order 1.
    double largest = 0.;
    for (std::size_t k = 0; k < std::size_t(n_owned) * width; ++k)
      largest = std::max(largest, std::abs(x[k]));
    if (!next && !(largest > 0.))
      return;
    const double scale = largest > 0. ? 1. / largest : 0.;
    for (unsigned int k = 0; k < n_interior; ++k)
      for (unsigned int c = 0; c < width; ++c)
        values[std::size_t(k) * width + c] =
          scale * x[std::size_t(order[k]) * width + c];
    std::fill(values.begin() + std::size_t(n_interior) * width,
              values.end(),
              0.f);
    interior.forward(values.data(), width, constrained_interior);
    if (next)
      solve_interface(x, width, largest);
    interior.backward(values.data(), width, constrained_interior);
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
    // The right-hand sides that the interiors of all processes leave.
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
    next->solve(y.begin(), width);
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
} // namespace greville

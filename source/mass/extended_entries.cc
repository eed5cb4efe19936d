// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/extended_mass.h>

#include <algorithm>

// The entries of E^T M~ E.
namespace greville
{
  using namespace dealii;

  namespace
  {
    /// A sparse matrix by rows.
    struct SparseRows
    {
      std::vector<std::size_t>  begin = {0};
      std::vector<unsigned int> columns;
      std::vector<double>       weights;

      void
      push_back(const unsigned int column, const double weight)
      {
        columns.push_back(column);
        weights.push_back(weight);
      }

      void
      end_row()
      {
        begin.push_back(columns.size());
      }

      template <typename Visit>
      void
      for_each(const unsigned int row, const Visit &visit) const
      {
        for (std::size_t e = begin[row]; e < begin[row + 1]; ++e)
          visit(columns[e], weights[e]);
      }
    };



    /// A pass through the columns of a matrix with ascending columns in each
    /// row.
    class ColumnPass
    {
    public:
      ColumnPass(const SparseRows &matrix, const unsigned int n_columns)
        : matrix(matrix)
        , next(matrix.begin.begin(), matrix.begin.end() - 1)
        , head(n_columns, none)
        , link(next.size())
      {
        for (unsigned int k = 0; k < next.size(); ++k)
          insert(k);
      }

      bool
      is_empty(const unsigned int column) const
      {
        return head[column] == none;
      }

      /// Call visit(k, weight) for the rows k with an entry in a column. Call
      /// finish() for all previous columns before.
      template <typename Visit>
      void
      for_each(const unsigned int column, const Visit &visit) const
      {
        for (unsigned int k = head[column]; k != none; k = link[k])
          visit(k, matrix.weights[next[k]]);
      }

      /// Return the first entry of row @p k from this column on.
      std::size_t
      entry(const unsigned int k) const
      {
        return next[k];
      }

      void
      finish(const unsigned int column)
      {
        for (unsigned int k = head[column]; k != none;)
          {
            const unsigned int other = link[k];
            ++next[k];
            insert(k);
            k = other;
          }
      }

    private:
      static constexpr unsigned int none = static_cast<unsigned int>(-1);

      void
      insert(const unsigned int k)
      {
        if (next[k] == matrix.begin[k + 1])
          return;
        unsigned int &first = head[matrix.columns[next[k]]];
        link[k]             = first;
        first               = k;
      }

      const SparseRows         &matrix;
      std::vector<std::size_t>  next; // by row
      std::vector<unsigned int> head; // by column
      std::vector<unsigned int> link; // by row
    };



    /// A row that is being summed up: its values, and bits that mark nonzero
    /// entries.
    class RowSum
    {
    public:
      explicit RowSum(const unsigned int n)
        : sums(n, 0.)
        , touched(n / n_bits + 1, 0)
      {}

      void
      add(const unsigned int column, const double value)
      {
        mark(column);
        lowest  = std::min(lowest, column / n_bits);
        highest = std::max(highest, column / n_bits);
        sums[column] += value;
      }

      /// Add a multiple of the entries from @p begin to the end of row @p k.
      void
      add(const SparseRows  &matrix,
          const unsigned int k,
          const std::size_t  begin,
          const double       factor)
      {
        const std::size_t end = matrix.begin[k + 1];
        if (begin == end)
          return;
        lowest  = std::min(lowest, matrix.columns[begin] / n_bits);
        highest = std::max(highest, matrix.columns[end - 1] / n_bits);
        for (std::size_t e = begin; e < end; ++e)
          {
            mark(matrix.columns[e]);
            sums[matrix.columns[e]] += factor * matrix.weights[e];
          }
      }

      /// Call visit(column, sum) for the entries, ascending, and clear the row.
      template <typename Visit>
      void
      take(const Visit &visit)
      {
        for (std::size_t word = lowest; word <= highest; ++word)
          for (; touched[word] != 0; touched[word] &= touched[word] - 1)
            {
              const unsigned int column =
                word * n_bits + __builtin_ctzll(touched[word]);
              visit(column, sums[column]);
              sums[column] = 0.;
            }
        lowest  = static_cast<unsigned int>(-1);
        highest = 0;
      }

    private:
      static constexpr unsigned int n_bits = 64;

      void
      mark(const unsigned int column)
      {
        touched[column / n_bits] |= std::uint64_t(1) << (column % n_bits);
      }

      std::vector<double>        sums;
      std::vector<std::uint64_t> touched;
      unsigned int               lowest  = static_cast<unsigned int>(-1);
      unsigned int               highest = 0;
    };
  } // namespace



  /**
   * With the unknowns u, the extended functions x and E = (1, W):
   * @f[
   *   A = M_{uu} + W^T C + C^T W, \qquad C = M_{xu} + M_{xx} W / 2.
   * @f]
   */
  template <int dim>
  class ExtendedMass<dim>::EntrySums
  {
  public:
    /// If @p rows is not null, only the entries between these unknowns are
    /// computed.
    EntrySums(const ExtendedMass<dim>          &mass,
              const unsigned int                components,
              const int                         reach,
              const std::vector<unsigned char> *rows = nullptr)
      : M(mass.points_mass)
      , reach(reach)
      , rows(rows)
      , E(*mass.E)
      , n(E.unknowns.size())
      , is_constrained(n, 0)
      , is_near_ghost(n, 0)
      , image_diagonal(n, 0.)
      , sum(n)
    {
      E.for_each_image_of_unknown(
        [&](const unsigned int u, const std::size_t place) {
          image_diagonal[u] += M.diagonal(place);
        });
      find_constrained(components);
      copy_weights();
      make_C();
      for (unsigned int u = E.n_owned; u < n; ++u)
        if (has_place(u))
          M.for_each_entry(
            E.unknowns[u],
            [&](const unsigned int j, const double) {
              if (E.signed_numbers[j] > 0)
                is_near_ghost[E.signed_numbers[j] - 1] = 1;
            },
            reach);
    }

    UpperTriangle
    run()
    {
      UpperTriangle result;
      ColumnPass    W_pass(W, n), C_pass(C, n);
      // An entry of W adds about six entries for blocks and balls. Reserve
      // memory: arrays that grow would exist twice.
      const std::size_t n_entries =
        std::size_t(n) * (Utilities::fixed_power<dim>(2 * reach + 1) / 2 + 1) +
        8 * W.columns.size();
      result.row_begin.reserve(n + 1);
      result.columns.reserve(n_entries);
      result.values.reserve(n_entries);
      for (unsigned int i = 0; i < n; ++i)
        {
          if (rows == nullptr && W_pass.is_empty(i) && C_pass.is_empty(i) &&
              is_plain(i))
            add_plain_row(result, i);
          else if (is_wanted(i))
            {
              sum_row(i, W_pass, C_pass);
              sum.take([&](const unsigned int j, const double value) {
                if (!is_wanted(j))
                  return;
                result.columns.push_back(j);
                result.values.push_back(value);
              });
            }
          W_pass.finish(i);
          C_pass.finish(i);
          result.row_begin.push_back(result.columns.size());
        }
      return result;
    }

  private:
    using Entry = typename ExtendedUnknowns<dim>::Entry;

    bool
    has_place(const unsigned int unknown) const
    {
      return E.unknowns[unknown] != numbers::invalid_unsigned_int;
    }

    bool
    is_wanted(const unsigned int unknown) const
    {
      return rows == nullptr || (*rows)[unknown];
    }

    /// Return whether wanted rows depend on the extended function number @p k.
    bool
    is_needed(const unsigned int k, const std::vector<unsigned char> &meets)
    {
      if (rows == nullptr || meets[k])
        return true;
      bool result = false;
      M.for_each_entry(
        E.extended[k],
        [&](const unsigned int j, const double) {
          const int number = E.signed_numbers[j];
          result           = result || (number > 0   ? is_wanted(number - 1)
                                        : number < 0 ? meets[-number - 1]
                                                     : false);
        },
        reach);
      return result;
    }

    /// Return which extended functions depend on wanted unknowns.
    std::vector<unsigned char>
    meet_wanted() const
    {
      std::vector<unsigned char> result(E.extended.size(), 0);
      for (unsigned int k = 0; k < E.extended.size(); ++k)
        W.for_each(k, [&](const unsigned int u, const double) {
          result[k] |= is_wanted(u);
        });
      return result;
    }

    /// Find unknowns that are constrained in all components.
    void
    find_constrained(const unsigned int components)
    {
      is_constrained_extended.assign(E.extended.size(), 0);
      for (const auto &entry : E.constrained_places)
        if ((entry.second & components) == components)
          {
            const int number = E.signed_numbers[entry.first];
            if (number > 0)
              is_constrained[number - 1] = 1;
            else if (number < 0)
              is_constrained_extended[-number - 1] = 1;
          }
    }

    /// W: the rows of E of extended functions, without constraints.
    void
    copy_weights()
    {
      std::vector<Entry> row;
      for (unsigned int k = 0; k < E.extended.size(); ++k)
        {
          row.clear();
          for (std::size_t e = E.extended_begin[k]; e < E.extended_begin[k + 1];
               ++e)
            if (!is_constrained_extended[k] &&
                !is_constrained[E.extended_entries[e].unknown])
              row.push_back(E.extended_entries[e]);
          // Sort by place: ghosts have the last numbers, not the last places.
          std::sort(row.begin(), row.end(), [](const Entry &a, const Entry &b) {
            return a.unknown < b.unknown;
          });
          for (const Entry &entry : row)
            W.push_back(entry.unknown, entry.weight);
          W.end_row();
        }
    }

    void
    make_C()
    {
      const auto meets = meet_wanted();
      for (unsigned int k = 0; k < E.extended.size(); ++k)
        {
          if (W.begin[k] < W.begin[k + 1] && is_needed(k, meets))
            M.for_each_entry(
              E.extended[k],
              [&](const unsigned int j, const double value) {
                const int number = E.signed_numbers[j];
                if (number > 0)
                  {
                    if (!is_constrained[number - 1])
                      sum.add(number - 1, value);
                  }
                else if (number < 0)
                  W.for_each(-number - 1,
                             [&](const unsigned int u, const double weight) {
                               sum.add(u, 0.5 * weight * value);
                             });
              },
              reach);
          sum.take([&](const unsigned int u, const double value) {
            C.push_back(u, value);
          });
          C.end_row();
        }
    }

    /// Return whether a row of A without entries of W and C has just the
    /// entries of M at this and later places, between free unknowns.
    bool
    is_plain(const unsigned int i) const
    {
      return i < E.n_owned && !is_near_ghost[i] && !is_constrained[i];
    }

    void
    add_plain_row(UpperTriangle &result, const unsigned int i) const
    {
      const std::size_t begin = result.columns.size();
      M.for_each_upper_entry(
        E.unknowns[i],
        [&](const unsigned int j, const double value) {
          const int number = E.signed_numbers[j];
          if (number <= 0 || is_constrained[number - 1])
            return;
          result.columns.push_back(number - 1);
          result.values.push_back(value);
        },
        reach);
      // All points of the unknown belong to other processes.
      if (result.columns.size() == begin || result.columns[begin] != i)
        {
          result.columns.insert(result.columns.begin() + begin, i);
          result.values.insert(result.values.begin() + begin, 0.);
        }
    }

    void
    sum_row(const unsigned int i,
            const ColumnPass  &W_pass,
            const ColumnPass  &C_pass)
    {
      sum.add(i, 0.);
      if (is_constrained[i])
        {
          if (has_place(i))
            sum.add(i, M.diagonal(E.unknowns[i]));
          sum.add(i, image_diagonal[i]);
          return;
        }
      const auto add_unknown = [&](const unsigned int j, const double value) {
        const int number = E.signed_numbers[j];
        if (number > 0 && unsigned(number - 1) >= i &&
            !is_constrained[number - 1])
          sum.add(number - 1, value);
      };
      if (has_place(i))
        {
          if (i < E.n_owned && !is_near_ghost[i])
            M.for_each_upper_entry(E.unknowns[i], add_unknown, reach);
          else
            M.for_each_entry(E.unknowns[i], add_unknown, reach);
        }
      // Add the rows of the products from column i on.
      W_pass.for_each(i, [&](const unsigned int k, const double factor) {
        sum.add(C, k, C_pass.entry(k), factor);
      });
      C_pass.for_each(i, [&](const unsigned int k, const double factor) {
        sum.add(W, k, W_pass.entry(k), factor);
      });
    }

    const StencilMatrix<dim>         &M;
    const int                         reach;
    const std::vector<unsigned char> *rows;
    const ExtendedUnknowns<dim>      &E;
    const unsigned int                n;
    std::vector<unsigned char>        is_constrained, is_constrained_extended;
    std::vector<unsigned char>        is_near_ghost;
    std::vector<double>               image_diagonal;
    SparseRows                        W, C;
    RowSum                            sum;
  };



  template <int dim>
  UpperTriangle
  ExtendedMass<dim>::local_entries(const unsigned int components,
                                   const int          reach) const
  {
    return EntrySums(*this, components, reach).run();
  }



  template <int dim>
  UpperTriangle
  ExtendedMass<dim>::local_entries(const unsigned int components) const
  {
    return local_entries(components, points_mass.space().degree());
  }



  template <int dim>
  std::vector<unsigned char>
  ExtendedMass<dim>::rows_that_differ(const int reach) const
  {
    constexpr unsigned char    all = (1u << dim) - 1;
    std::vector<unsigned char> result(E->unknowns.size(), 0);
    const auto                 mark_unknowns_of = [&](const std::size_t place) {
      E->for_each_unknown(place, [&](const unsigned int u, const double) {
        result[u] = 1;
      });
    };
    for (const auto &[place, components] : E->constrained_places)
      if (components != all)
        {
          mark_unknowns_of(place);
          if (E->signed_numbers[place] < 0)
            points_mass.for_each_entry(
              place,
              [&](const unsigned int j, const double) { mark_unknowns_of(j); },
              reach);
        }
    VectorType flags;
    E->initialize_vector(flags, 1);
    std::copy(result.begin(), result.end(), flags.begin());
    flags.compress(VectorOperation::add);
    flags.update_ghost_values();
    for (unsigned int u = 0; u < result.size(); ++u)
      result[u] = flags.local_element(u) > 0.;
    return result;
  }



  template <int dim>
  RowVariants
  ExtendedMass<dim>::row_variants(const int reach) const
  {
    RowVariants result;
    const auto &partly = E->component_is_partly_constrained;
    if (std::count(partly.begin(), partly.end(), true) == 0)
      return result;
    result.differs = rows_that_differ(reach);
    result.fixed.assign(E->n_owned, 0);
    for (unsigned int c = 0; c < dim; ++c)
      {
        result.of_component.push_back(0);
        if (!partly[c])
          continue;
        result.matrices.push_back(
          EntrySums(*this, 1u << c, reach, &result.differs).run());
        result.of_component[c] = result.matrices.size();
        for (unsigned int u = 0; u < E->n_owned; ++u)
          if (E->is_constrained(E->owned_unknown_functions[u], c))
            result.fixed[u] |= 1u << result.of_component[c];
      }
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(ExtendedMass);
} // namespace greville

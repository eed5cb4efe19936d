// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/extended_mass.h>

#include <algorithm>
#include <numeric>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  ExtendedMass<dim>::reinit(const SplineSpace<dim> &space)
  {
    points_mass.reinit(space);
    E = std::make_shared<ExtendedUnknowns<dim>>();
    E->reinit(points_mass);
  }



  template <int dim>
  void
  ExtendedMass<dim>::reinit(const ExtendedMass<dim> &other)
  {
    points_mass.reinit(other.points_mass.space());
    E = other.E;
  }



  template <int dim>
  void
  ExtendedMass<dim>::begin(const Extension<dim> &extension, const bool changed)
  {
    begin(E->update(extension, changed));
  }



  template <int dim>
  void
  ExtendedMass<dim>::begin(const bool changed)
  {
    if (!changed)
      {
        points_mass.clear();
        return;
      }
    std::vector<unsigned int> active;
    E->for_each_active(E->constrained_functions.size(),
                       [&](const unsigned int f, const std::size_t) {
                         active.push_back(f);
                       });
    points_mass.set_rows(active);
  }



  template <int dim>
  void
  ExtendedMass<dim>::finish()
  {
    // If points lie only at the outermost edge of a function's support, its
    // mass is round-off.
    double largest = 0.;
    for (const unsigned int place : E->unknowns)
      if (place != numbers::invalid_unsigned_int)
        largest = std::max(largest, points_mass.diagonal(place));
    for (const unsigned int place : E->lumped)
      {
        points_mass.decouple(place);
        points_mass.raise_diagonal(place, 1e-15 * largest);
      }
  }



  template <int dim>
  void
  ExtendedMass<dim>::vmult(VectorType        &y,
                           VectorType        &x,
                           const unsigned int width) const
  {
    E->multiply(y, x, width, [&](double *to, const double *from) {
      points_mass.vmult(to, from, width);
    });
  }



  template <int dim>
  void
  ExtendedMass<dim>::subtract_constrained(
    VectorType                            &rows,
    const std::vector<VectorField<dim> *> &fields,
    const unsigned int                     width) const
  {
    const auto columns              = columns_of<VectorType>(fields);
    const auto for_each_constrained = [&](const bool  everywhere,
                                          const auto &visit) {
      const auto at = [&](const unsigned int f, const std::size_t place) {
        if (E->constrained_functions[f] != 0)
          for (unsigned int c = 0; c < columns.size(); ++c)
            if (E->is_constrained(f, c))
              visit(c, place, columns[c]->local_element(f));
      };
      if (std::count(E->component_has_constrained.begin(),
                     E->component_has_constrained.end(),
                     true) == 0)
        return;
      if (everywhere)
        E->for_each_active_place(at);
      else
        E->for_each_active(E->n_owned_functions(), at);
    };
    VectorType x, y;
    E->initialize_vector(x, width);
    bool any = false;
    for_each_constrained(
      false,
      [&](const unsigned int c, const std::size_t place, const double value) {
        any = any || value != 0.;
        if (E->signed_numbers[place] > 0)
          x.local_element((E->signed_numbers[place] - 1) * width + c) = value;
      });
    // Walls at rest contribute nothing.
    if (Utilities::MPI::max<unsigned int>(any, E->communicator()) == 0)
      return;

    x.update_ghost_values();
    E->expand(x.begin(), width);
    for (const VectorType *column : columns)
      column->update_ghost_values();
    for_each_constrained(true,
                         [&](const unsigned int c,
                             const std::size_t  place,
                             const double       value) {
                           E->place_x[place * width + c] = value;
                         });
    for (VectorType *column : columns)
      column->zero_out_ghost_values();
    points_mass.vmult(E->place_y.data(), E->place_x.data(), width);
    E->zero_constrained(E->place_y.data(), width);
    E->initialize_vector(y, width);
    E->collect(y.begin(), width);
    y.compress(VectorOperation::add);
    rows.add(-1., y);
    E->zero_constrained_unknowns(rows, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::multiply_field(VectorField<dim>       &rows,
                                    const VectorField<dim> &field) const
  {
    VectorType y;
    E->initialize_vector(y, 1);
    for (unsigned int c = 0; c < dim; ++c)
      {
        E->to_places(field[c]);
        points_mass.vmult(E->place_y.data(), E->place_x.data(), 1);
        for (const auto &[place, components] : E->constrained_places)
          if ((components >> c) & 1)
            E->place_y[place] = 0.;
        E->collect(y.begin(), 1);
        y.compress(VectorOperation::add);
        rows[c] = 0.;
        for (unsigned int u = 0; u < E->n_owned; ++u)
          rows[c].local_element(E->owned_unknown_functions[u]) =
            y.local_element(u);
      }
  }



  template <int dim>
  double
  ExtendedMass<dim>::row(const std::size_t place) const
  {
    double sum = 0.;
    points_mass.for_each_entry(place,
                               [&](const unsigned int j, const double value) {
                                 sum += value * E->place_x[j];
                               });
    return sum;
  }



  template <int dim>
  void
  ExtendedMass<dim>::multiply_constrained_rows(
    VectorField<dim> &rows, const VectorField<dim> &field) const
  {
    for (unsigned int c = 0; c < dim; ++c)
      {
        rows[c] = 0.;
        if (!E->component_has_constrained[c])
          continue;
        E->to_places(field[c]);
        E->for_each_active_place(
          [&](const unsigned int f, const std::size_t place) {
            if (E->is_constrained(f, c))
              rows[c].local_element(f) += row(place);
          });
        rows[c].compress(VectorOperation::add);
      }
  }



  template <int dim>
  void
  ExtendedMass<dim>::constrained_rows(VectorField<dim>       &rows,
                                      const VectorField<dim> &field,
                                      const VectorField<dim> &b) const
  {
    VectorType y;
    E->initialize_vector(y, 1);
    for (unsigned int c = 0; c < dim; ++c)
      {
        rows[c] = 0.;
        if (!E->component_has_constrained[c])
          continue;
        y = 0.;
        E->to_places(field[c]);
        const auto add = [&](const unsigned int f,
                             const std::size_t  place,
                             const double       known) {
          if (E->is_constrained(f, c))
            rows[c].local_element(f) += row(place) - known;
          else if (E->may_extend_constrained(place, c))
            {
              const double value = row(place) - known;
              E->for_each_unknown(place,
                                  [&](const unsigned int u,
                                      const double       weight) {
                                    y.local_element(u) += weight * value;
                                  });
            }
        };
        E->for_each_active(E->constrained_functions.size(),
                           [&](const unsigned int f, const std::size_t place) {
                             add(f,
                                 place,
                                 f < E->n_owned_functions()
                                   ? b[c].local_element(f)
                                   : 0.);
                           });
        E->for_each_active_image(
          [&](const unsigned int f, const std::size_t place) {
            add(f, place, 0.);
          });
        rows[c].compress(VectorOperation::add);
        y.compress(VectorOperation::add);
        for (unsigned int u = 0; u < E->n_owned; ++u)
          {
            const unsigned int f = E->owned_unknown_functions[u];
            if (E->is_constrained(f, c))
              rows[c].local_element(f) += y.local_element(u);
          }
      }
  }



  template <int dim>
  void
  ExtendedMass<dim>::approximate_diagonal(VectorType &diagonal) const
  {
    E->initialize_vector(diagonal, 1);
    for (unsigned int u = 0; u < E->unknowns.size(); ++u)
      if (E->unknowns[u] != numbers::invalid_unsigned_int)
        diagonal.local_element(u) = points_mass.diagonal(E->unknowns[u]);
    E->for_each_image_of_unknown(
      [&](const unsigned int u, const std::size_t place) {
        diagonal.local_element(u) += points_mass.diagonal(place);
      });
    diagonal.compress(VectorOperation::add);
  }



  template <int dim>
  LowerTriangle
  ExtendedMass<dim>::local_entries(const unsigned int components) const
  {
    using Entry          = typename ExtendedUnknowns<dim>::Entry;
    const unsigned int n = E->unknowns.size();
    LowerTriangle      result;

    std::vector<double> image_diagonal(n, 0.);
    E->for_each_image_of_unknown(
      [&](const unsigned int u, const std::size_t place) {
        image_diagonal[u] += points_mass.diagonal(place);
      });

    // Leave out unknowns and extended functions that are constrained in all
    // components.
    std::vector<unsigned char> is_constrained(n, 0);
    std::vector<unsigned char> is_constrained_extended(E->extended.size(), 0);
    for (const auto &entry : E->constrained_places)
      if ((entry.second & components) == components)
        {
          const int signed_number = E->signed_numbers[entry.first];
          if (signed_number > 0)
            is_constrained[signed_number - 1] = 1;
          else if (signed_number < 0)
            is_constrained_extended[-signed_number - 1] = 1;
        }

    // A row that is being summed up, its end, and bits that mark its entries.
    constexpr unsigned int     n_bits = 64;
    std::vector<double>        sums(n, 0.);
    std::vector<std::uint64_t> touched(n / n_bits + 1, 0);
    unsigned int               lowest = n, highest = 0;
    const auto add_entry = [&](const unsigned int unknown, const double value) {
      if (is_constrained[unknown])
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
          const int signed_number = E->signed_numbers[j];
          if (signed_number > 0)
            {
              if (unsigned(signed_number - 1) <= last)
                add_entry(signed_number - 1, value);
            }
          else if (signed_number < 0 &&
                   !is_constrained_extended[-signed_number - 1])
            for (std::size_t e = E->extended_begin[-signed_number - 1];
                 e < E->extended_begin[-signed_number];
                 ++e)
              if (E->extended_entries[e].unknown <= last)
                add_entry(E->extended_entries[e].unknown,
                          E->extended_entries[e].weight * value);
        });
    };

    // Compute B = M E in the rows of extended functions.
    std::vector<std::size_t> B_begin(1, 0);
    std::vector<Entry>       B;
    for (unsigned int k = 0; k < E->extended.size(); ++k)
      {
        if (!is_constrained_extended[k])
          add_row_times_E(E->extended[k], n);
        take_row([&](const unsigned int j, const double value) {
          B.push_back({j, value});
        });
        B_begin.push_back(B.size());
      }

    // The extended functions of each unknown.
    std::vector<std::size_t> transpose_begin(n + 1, 0);
    for (const auto &entry : E->extended_entries)
      ++transpose_begin[entry.unknown + 1];
    std::partial_sum(transpose_begin.begin(),
                     transpose_begin.end(),
                     transpose_begin.begin());
    std::vector<Entry> transpose(E->extended_entries.size());
    {
      auto next = transpose_begin;
      for (unsigned int k = 0; k < E->extended.size(); ++k)
        for (std::size_t e = E->extended_begin[k]; e < E->extended_begin[k + 1];
             ++e)
          transpose[next[E->extended_entries[e].unknown]++] = {
            k, E->extended_entries[e].weight};
    }

    // Unknowns that are not coupled to extended functions have the entries of
    // M.
    std::vector<bool> is_plain(n, true);
    for (unsigned int u = 0; u < n; ++u)
      is_plain[u] =
        transpose_begin[u] == transpose_begin[u + 1] && u < E->n_owned;
    for (const unsigned int place : E->extended)
      points_mass.for_each_entry(place,
                                 [&](const unsigned int j, const double) {
                                   if (E->signed_numbers[j] > 0)
                                     is_plain[E->signed_numbers[j] - 1] = false;
                                 });

    // Compute the lower part of A = E^T B with the rows of B = M E.
    const unsigned int length =
      2 * points_mass.space().degree() + 1; // of a stencil
    const std::size_t n_entries =
      std::size_t(n) * (Utilities::fixed_power<dim>(length) / 2 + 1);
    result.row_begin.reserve(n + 1);
    result.columns.reserve(n_entries);
    result.values.reserve(n_entries);
    for (unsigned int i = 0; i < n; ++i)
      {
        if (is_constrained[i])
          {
            const bool has_place =
              E->unknowns[i] != numbers::invalid_unsigned_int;
            result.columns.push_back(i);
            result.values.push_back(has_place
                                      ? points_mass.diagonal(E->unknowns[i]) +
                                          image_diagonal[i]
                                      : 0.);
            result.row_begin.push_back(result.columns.size());
            continue;
          }
        if (is_plain[i])
          {
            points_mass.for_each_lower_entry(
              E->unknowns[i], [&](const unsigned int j, const double value) {
                // The entries of ghosts, which come last, are in the rows of
                // the ghosts.
                const int signed_number = E->signed_numbers[j];
                if (signed_number <= 0 || unsigned(signed_number - 1) > i ||
                    is_constrained[signed_number - 1])
                  return;
                result.columns.push_back(signed_number - 1);
                result.values.push_back(value);
              });
            // All points of the unknown belong to other processes.
            if (result.columns.size() == result.row_begin.back() ||
                result.columns.back() != i)
              {
                result.columns.push_back(i);
                result.values.push_back(0.);
              }
            result.row_begin.push_back(result.columns.size());
            continue;
          }
        if (E->unknowns[i] != numbers::invalid_unsigned_int)
          add_row_times_E(E->unknowns[i], i);
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
    return result;
  }



  template class ExtendedMass<2>;
  template class ExtendedMass<3>;
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

// Fields of the space as vectors of unknowns, and back.

#include <greville/base/with_width.h>
#include <greville/mass/extended_unknowns.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  ExtendedUnknowns<dim>::restrict_columns(
    VectorType                            &rows,
    const std::vector<const VectorType *> &columns,
    const unsigned int                     width,
    const unsigned int                     component) const
  {
    // Use plain pointers and bits, for a loop without calls.
    std::array<const double *, max_width> from;
    std::array<unsigned int, max_width>   bit;
    const unsigned int                    n = columns.size();
    for (unsigned int c = 0; c < n; ++c)
      {
        from[c] = columns[c]->begin();
        bit[c]  = (component + c) % dim;
      }
    for_each_active(constrained_functions.size(),
                    [&](const unsigned int f, const std::size_t place) {
                      double        *to          = &place_y[place * width];
                      const bool     is_owned    = f < n_owned_functions();
                      const unsigned constrained = constrained_functions[f];
                      for (unsigned int c = 0; c < n; ++c)
                        to[c] = is_owned && !((constrained >> bit[c]) & 1)
                                  ? from[c][f]
                                  : 0.;
                      std::fill(to + n, to + width, 0.);
                    });
    for_each_active_image([&](const unsigned int, const std::size_t place) {
      std::fill_n(&place_y[place * width], width, 0.);
    });
    rows = 0.;
    collect(rows.begin(), width, place_y.data());
    rows.compress(VectorOperation::add);
    for (unsigned int u = 0; u < n_owned; ++u)
      for (unsigned int c = 0; c < columns.size(); ++c)
        if (is_constrained(owned_unknown_functions[u], component + c))
          rows.local_element(u * width + c) = 0.;
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::write_columns(const std::vector<VectorType *> &columns,
                                       VectorType                      &x,
                                       const unsigned int               width,
                                       const unsigned int component) const
  {
    x.update_ghost_values();
    expand(x.begin(), width, place_x.data());
    x.zero_out_ghost_values();
    std::array<double *, max_width>     to;
    std::array<unsigned int, max_width> bit;
    const unsigned int                  n = columns.size();
    for (unsigned int c = 0; c < n; ++c)
      {
        to[c]  = columns[c]->begin();
        bit[c] = (component + c) % dim;
      }
    for (unsigned int f = 0; f < n_owned_functions(); ++f)
      {
        const bool    is_active = (*extension)[f] != Extension<dim>::inactive;
        const double *values = &place_x[std::size_t(stencil->place(f)) * width];
        const unsigned constrained = constrained_functions[f];
        for (unsigned int c = 0; c < n; ++c)
          if (!((constrained >> bit[c]) & 1))
            to[c][f] = is_active ? values[c] : 0.;
      }
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::restrict_fields(
    VectorType                                  &rows,
    const std::vector<const VectorField<dim> *> &fields,
    const unsigned int                           width) const
  {
    restrict_columns(rows, columns_of<const VectorType>(fields), width);
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::read_fields(
    VectorType                                  &x,
    const std::vector<const VectorField<dim> *> &fields,
    const unsigned int                           width) const
  {
    const auto columns = columns_of<const VectorType>(fields);
    for (unsigned int u = 0; u < n_owned; ++u)
      for (unsigned int c = 0; c < columns.size(); ++c)
        x.local_element(u * width + c) =
          columns[c]->local_element(owned_unknown_functions[u]);
    zero_constrained_unknowns(x, width);
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::write_fields(
    const std::vector<VectorField<dim> *> &fields,
    VectorType                            &x,
    const unsigned int                     width) const
  {
    // Extended functions also depend on constrained unknowns.
    const auto columns = columns_of<VectorType>(fields);
    for (unsigned int u = 0; u < n_owned; ++u)
      for (unsigned int c = 0; c < columns.size(); ++c)
        if (is_constrained(owned_unknown_functions[u], c))
          x.local_element(u * width + c) =
            columns[c]->local_element(owned_unknown_functions[u]);
    write_columns(columns, x, width);
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::to_places(const VectorType &component) const
  {
    component.update_ghost_values();
    for_each_active_place([&](const unsigned int f, const std::size_t place) {
      place_x[place] = component.local_element(f);
    });
    component.zero_out_ghost_values();
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::extend(VectorField<dim> &field,
                                const VectorType &weights) const
  {
    constexpr unsigned int width = dim == 2 ? 2 : 4;
    VectorType             x, taken;
    initialize_vector(x, width);
    initialize_vector(taken, width);
    read_fields(x, {&field}, width);
    std::vector<std::array<double, dim>> old(extended_functions.size());
    for (unsigned int k = 0; k < extended_functions.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        if (extended_functions[k] < n_owned_functions())
          old[k][c] = field[c].local_element(extended_functions[k]);
    write_fields({&field}, x, width);
    for (unsigned int k = 0; k < extended_functions.size(); ++k)
      {
        const unsigned int f = extended_functions[k];
        if (f >= n_owned_functions())
          continue;
        const std::size_t n = extended_begin[k + 1] - extended_begin[k];
        for (unsigned int c = 0; c < dim; ++c)
          {
            const double part = weights.local_element(f) *
                                (field[c].local_element(f) - old[k][c]) / n;
            for (std::size_t e = extended_begin[k]; e < extended_begin[k + 1];
                 ++e)
              taken.local_element(extended_entries[e].unknown * width + c) +=
                part;
          }
      }
    taken.compress(VectorOperation::add);
    for (unsigned int u = 0; u < n_owned; ++u)
      {
        const unsigned int f = owned_unknown_functions[u];
        for (unsigned int c = 0; c < dim; ++c)
          if (weights.local_element(f) > 0.)
            field[c].local_element(f) -=
              taken.local_element(u * width + c) / weights.local_element(f);
      }
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::read(VectorType        &unknown_values,
                              const VectorType  &x,
                              const unsigned int width) const
  {
    for (unsigned int u = 0; u < n_owned; ++u)
      for (unsigned int c = 0; c < width; ++c)
        unknown_values.local_element(u * width + c) =
          x.local_element(owned_unknown_functions[u] * width + c);
    zero_constrained_unknowns(unknown_values, width);
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::write(VectorType        &x,
                               const VectorType  &unknown_values,
                               const unsigned int width) const
  {
    x = 0.;
    for (unsigned int u = 0; u < n_owned; ++u)
      for (unsigned int c = 0; c < width; ++c)
        x.local_element(owned_unknown_functions[u] * width + c) =
          unknown_values.local_element(u * width + c);
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::distribute(VectorType        &x,
                                    const unsigned int component) const
  {
    if (column.get_partitioner() != layout->partitioner(1))
      initialize_vector(column, 1);
    for (unsigned int u = 0; u < n_owned; ++u)
      {
        const unsigned int f = owned_unknown_functions[u];
        column.local_element(u) =
          is_constrained(f, component) ? 0. : x.local_element(f);
      }
    x = 0.;
    write_columns({&x}, column, 1, component);
  }



  template <int dim>
  void
  ExtendedUnknowns<dim>::condense(VectorType        &x,
                                  const unsigned int component) const
  {
    if (column.get_partitioner() != layout->partitioner(1))
      initialize_vector(column, 1);
    restrict_columns(column, {&x}, 1, component);
    x = 0.;
    for (unsigned int u = 0; u < n_owned; ++u)
      {
        const unsigned int f = owned_unknown_functions[u];
        if (!is_constrained(f, component))
          x.local_element(f) = column.local_element(u);
      }
  }



  GREVILLE_INSTANTIATE_CLASS(ExtendedUnknowns);
} // namespace greville

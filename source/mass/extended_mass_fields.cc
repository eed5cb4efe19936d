// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/extended_mass.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  template <typename Visit>
  void
  ExtendedMass<dim>::for_each_active(const unsigned int n_functions,
                                     const Visit       &visit) const
  {
    for (unsigned int f = 0; f < n_functions; ++f)
      if ((*extension)[f] != Extension<dim>::inactive)
        visit(f, std::size_t(points_mass.place(f)));
  }



  template <int dim>
  void
  ExtendedMass<dim>::condense(VectorType &rows, const VectorType &b) const
  {
    restrict_columns(rows, {&b}, 1);
  }



  template <int dim>
  void
  ExtendedMass<dim>::distribute(VectorType &values, VectorType &x) const
  {
    write_columns({&values}, x, 1);
  }



  template <int dim>
  void
  ExtendedMass<dim>::restrict_columns(
    VectorType                            &rows,
    const std::vector<const VectorType *> &columns,
    const unsigned int                     width) const
  {
    for_each_active(n_functions(),
                    [&](const unsigned int f, const std::size_t place) {
                      for (unsigned int c = 0; c < columns.size(); ++c)
                        place_y[place * width + c] =
                          f < n_owned_functions() && !is_held(f, c)
                            ? columns[c]->local_element(f)
                            : 0.;
                    });
    rows = 0.;
    collect(rows.begin(), width);
    rows.compress(VectorOperation::add);
    zero_held_unknowns(rows, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::write_columns(const std::vector<VectorType *> &columns,
                                   VectorType                      &x,
                                   const unsigned int               width) const
  {
    x.update_ghost_values();
    expand(x.begin(), width);
    x.zero_out_ghost_values();
    for (unsigned int f = 0; f < n_owned_functions(); ++f)
      for (unsigned int c = 0; c < columns.size(); ++c)
        if (!is_held(f, c))
          columns[c]->local_element(f) =
            (*extension)[f] == Extension<dim>::inactive
              ? 0.
              : place_x[std::size_t(points_mass.place(f)) * width + c];
  }



  namespace
  {
    /**
     * The components of fields, one behind the other.
     */
    template <typename Vector, typename Field>
    std::vector<Vector *>
    columns_of(const std::vector<Field *> &fields)
    {
      std::vector<Vector *> result;
      for (Field *field : fields)
        for (Vector &component : *field)
          result.push_back(&component);
      return result;
    }
  } // namespace



  template <int dim>
  void
  ExtendedMass<dim>::restrict_fields(
    VectorType                                  &rows,
    const std::vector<const VectorField<dim> *> &fields,
    const unsigned int                           width) const
  {
    restrict_columns(rows, columns_of<const VectorType>(fields), width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::read_fields(
    VectorType                                  &x,
    const std::vector<const VectorField<dim> *> &fields,
    const unsigned int                           width) const
  {
    const auto columns = columns_of<const VectorType>(fields);
    for (unsigned int u = 0; u < n_owned; ++u)
      for (unsigned int c = 0; c < columns.size(); ++c)
        x.local_element(u * width + c) =
          columns[c]->local_element(owned_unknown_functions[u]);
    zero_held_unknowns(x, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::write_fields(const std::vector<VectorField<dim> *> &fields,
                                  VectorType                            &x,
                                  const unsigned int width) const
  {
    // Extended functions depend on held unknowns, too.
    const auto columns = columns_of<VectorType>(fields);
    for (unsigned int u = 0; u < n_owned; ++u)
      for (unsigned int c = 0; c < columns.size(); ++c)
        if (is_held(owned_unknown_functions[u], c))
          x.local_element(u * width + c) =
            columns[c]->local_element(owned_unknown_functions[u]);
    write_columns(columns, x, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::subtract_held(
    VectorType                            &rows,
    const std::vector<VectorField<dim> *> &fields,
    const unsigned int                     width) const
  {
    const auto columns  = columns_of<VectorType>(fields);
    const auto for_held = [&](const unsigned int n, const auto &visit) {
      if (std::count(component_has_held.begin(),
                     component_has_held.end(),
                     true) > 0)
        for_each_active(n, [&](const unsigned int f, const std::size_t place) {
          if (held_functions[f] != 0)
            for (unsigned int c = 0; c < columns.size(); ++c)
              if (is_held(f, c))
                visit(c, place, columns[c]->local_element(f));
        });
    };
    VectorType x, y;
    initialize_vector(x, width);
    bool any = false;
    for_held(n_owned_functions(),
             [&](const unsigned int c,
                 const std::size_t  place,
                 const double       value) {
               any = any || value != 0.;
               if (roles[place] > 0)
                 x.local_element((roles[place] - 1) * width + c) = value;
             });
    // Walls at rest contribute nothing.
    if (Utilities::MPI::max<unsigned int>(any, communicator()) == 0)
      return;

    x.update_ghost_values();
    expand(x.begin(), width);
    for (const VectorType *column : columns)
      column->update_ghost_values();
    for_held(n_functions(),
             [&](const unsigned int c,
                 const std::size_t  place,
                 const double value) { place_x[place * width + c] = value; });
    for (VectorType *column : columns)
      column->zero_out_ghost_values();
    points_mass.vmult(place_y.data(), place_x.data(), width);
    zero_held(place_y.data(), width);
    initialize_vector(y, width);
    collect(y.begin(), width);
    y.compress(VectorOperation::add);
    rows.add(-1., y);
    zero_held_unknowns(rows, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::to_places(const VectorType &component) const
  {
    component.update_ghost_values();
    for_each_active(n_functions(),
                    [&](const unsigned int f, const std::size_t place) {
                      place_x[place] = component.local_element(f);
                    });
    component.zero_out_ghost_values();
  }



  template <int dim>
  void
  ExtendedMass<dim>::multiply_field(VectorField<dim>       &rows,
                                    const VectorField<dim> &field) const
  {
    VectorType y;
    initialize_vector(y, 1);
    for (unsigned int c = 0; c < dim; ++c)
      {
        to_places(field[c]);
        points_mass.vmult(place_y.data(), place_x.data(), 1);
        collect(y.begin(), 1);
        y.compress(VectorOperation::add);
        rows[c] = 0.;
        for (unsigned int u = 0; u < n_owned; ++u)
          rows[c].local_element(owned_unknown_functions[u]) =
            y.local_element(u);
      }
  }



  template <int dim>
  void
  ExtendedMass<dim>::multiply_at_held(VectorField<dim>       &rows,
                                      const VectorField<dim> &field) const
  {
    for (unsigned int c = 0; c < dim; ++c)
      {
        rows[c] = 0.;
        if (!component_has_held[c])
          continue;
        to_places(field[c]);
        for_each_active(n_functions(),
                        [&](const unsigned int f, const std::size_t place) {
                          if (!is_held(f, c))
                            return;
                          double sum = 0.;
                          points_mass.for_each_entry(place,
                                                     [&](const unsigned int j,
                                                         const double value) {
                                                       sum +=
                                                         value * place_x[j];
                                                     });
                          rows[c].local_element(f) = sum;
                        });
        rows[c].compress(VectorOperation::add);
      }
  }



  template <int dim>
  void
  ExtendedMass<dim>::approximate_diagonal(VectorType &diagonal) const
  {
    initialize_vector(diagonal, 1);
    for (unsigned int u = 0; u < unknowns.size(); ++u)
      if (unknowns[u] != numbers::invalid_unsigned_int)
        diagonal.local_element(u) = points_mass.diagonal(unknowns[u]);
    diagonal.compress(VectorOperation::add);
  }



  template <int dim>
  void
  ExtendedMass<dim>::extend(VectorField<dim> &field,
                            const VectorType &weights) const
  {
    constexpr unsigned int width = dim == 2 ? 2 : 4;
    VectorType             x, taken;
    initialize_vector(x, width);
    initialize_vector(taken, width);
    read_fields(x, {&field}, width);
    std::vector<std::array<double, dim>> old(extended.size());
    for (unsigned int k = 0; k < extended.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        if (extended_functions[k] < n_owned_functions())
          old[k][c] = field[c].local_element(extended_functions[k]);
    write_fields({&field}, x, width);
    for (unsigned int k = 0; k < extended.size(); ++k)
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



  // The members of this source.
#define INSTANTIATE(dim)                                                       \
  template void ExtendedMass<dim>::condense(VectorType &, const VectorType &)  \
    const;                                                                     \
  template void ExtendedMass<dim>::distribute(VectorType &, VectorType &)      \
    const;                                                                     \
  template void ExtendedMass<dim>::restrict_fields(                            \
    VectorType &,                                                              \
    const std::vector<const VectorField<dim> *> &,                             \
    const unsigned int) const;                                                 \
  template void ExtendedMass<dim>::read_fields(                                \
    VectorType &,                                                              \
    const std::vector<const VectorField<dim> *> &,                             \
    const unsigned int) const;                                                 \
  template void ExtendedMass<dim>::write_fields(                               \
    const std::vector<VectorField<dim> *> &, VectorType &, const unsigned int) \
    const;                                                                     \
  template void ExtendedMass<dim>::subtract_held(                              \
    VectorType &, const std::vector<VectorField<dim> *> &, const unsigned int) \
    const;                                                                     \
  template void ExtendedMass<dim>::multiply_field(VectorField<dim> &,          \
                                                  const VectorField<dim> &)    \
    const;                                                                     \
  template void ExtendedMass<dim>::multiply_at_held(VectorField<dim> &,        \
                                                    const VectorField<dim> &)  \
    const;                                                                     \
  template void ExtendedMass<dim>::approximate_diagonal(VectorType &) const;   \
  template void ExtendedMass<dim>::extend(VectorField<dim> &,                  \
                                          const VectorType &) const
  INSTANTIATE(2);
  INSTANTIATE(3);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/extended_mass.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  ExtendedMass<dim>::condense_column(double            *to,
                                     const unsigned int width,
                                     const double      *b,
                                     const unsigned int component) const
  {
    const auto is_held = [&](const unsigned int f) {
      return (held_functions[f] >> component) & 1;
    };
    for (unsigned int u = 0; u < n_owned; ++u)
      if (!is_held(owned_unknown_functions[u]))
        to[std::size_t(u) * width] = b[owned_unknown_functions[u]];
    for (unsigned int m = 0; m < extended.size(); ++m)
      {
        const unsigned int f = extended_functions[m];
        if (f >= n_owned_functions() || is_held(f))
          continue;
        for (std::size_t e = extended_begin[m]; e < extended_begin[m + 1]; ++e)
          to[std::size_t(extended_entries[e].unknown) * width] +=
            extended_entries[e].weight * b[f];
      }
  }



  template <int dim>
  void
  ExtendedMass<dim>::distribute_column(double            *values,
                                       const double      *from,
                                       const unsigned int width,
                                       const unsigned int component) const
  {
    const auto is_held = [&](const unsigned int f) {
      return (held_functions[f] >> component) & 1;
    };
    for (unsigned int f = 0; f < n_owned_functions(); ++f)
      if ((*extension)[f] == Extension<dim>::inactive && !is_held(f))
        values[f] = 0.;
    for (unsigned int u = 0; u < n_owned; ++u)
      if (!is_held(owned_unknown_functions[u]))
        values[owned_unknown_functions[u]] = from[std::size_t(u) * width];
    for (unsigned int m = 0; m < extended.size(); ++m)
      {
        const unsigned int f = extended_functions[m];
        if (f >= n_owned_functions() || is_held(f))
          continue;
        double sum = 0.;
        for (std::size_t e = extended_begin[m]; e < extended_begin[m + 1]; ++e)
          sum += extended_entries[e].weight *
                 from[std::size_t(extended_entries[e].unknown) * width];
        values[f] = sum;
      }
  }



  template <int dim>
  void
  ExtendedMass<dim>::condense(VectorType &rows, const VectorType &b) const
  {
    rows = 0.;
    condense_column(rows.begin(), 1, b.begin(), 0);
    rows.compress(VectorOperation::add);
  }



  template <int dim>
  void
  ExtendedMass<dim>::distribute(VectorType &values, VectorType &x) const
  {
    x.update_ghost_values();
    distribute_column(values.begin(), x.begin(), 1, 0);
    x.zero_out_ghost_values();
  }



  template <int dim>
  void
  ExtendedMass<dim>::restrict_fields(
    VectorType                                  &rows,
    const std::vector<const VectorField<dim> *> &fields,
    const unsigned int                           width) const
  {
    rows = 0.;
    for (unsigned int k = 0; k < fields.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        condense_column(rows.begin() + k * dim + c,
                        width,
                        (*fields[k])[c].begin(),
                        c);
    rows.compress(VectorOperation::add);
    zero_held_unknowns(rows, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::read_fields(
    VectorType                                  &x,
    const std::vector<const VectorField<dim> *> &fields,
    const unsigned int                           width) const
  {
    for (unsigned int k = 0; k < fields.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        {
          const double *values = (*fields[k])[c].begin();
          double       *to     = x.begin() + k * dim + c;
          for (unsigned int u = 0; u < n_owned; ++u)
            to[std::size_t(u) * width] = values[owned_unknown_functions[u]];
        }
    zero_held_unknowns(x, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::write_fields(const std::vector<VectorField<dim> *> &fields,
                                  VectorType                            &x,
                                  const unsigned int width) const
  {
    // Extended functions depend on held unknowns, too.
    const auto &mask = held_functions;
    for (unsigned int u = 0; u < n_owned; ++u)
      if (mask[owned_unknown_functions[u]] != 0)
        for (unsigned int k = 0; k < fields.size(); ++k)
          for (unsigned int c = 0; c < dim; ++c)
            if ((mask[owned_unknown_functions[u]] >> c) & 1)
              x.local_element(u * width + k * dim + c) =
                (*fields[k])[c].local_element(owned_unknown_functions[u]);
    x.update_ghost_values();
    for (unsigned int k = 0; k < fields.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        distribute_column((*fields[k])[c].begin(),
                          x.begin() + k * dim + c,
                          width,
                          c);
    x.zero_out_ghost_values();
  }



  template <int dim>
  void
  ExtendedMass<dim>::subtract_held(
    VectorType                            &rows,
    const std::vector<VectorField<dim> *> &fields,
    const unsigned int                     width) const
  {
    bool        any       = false;
    const auto &mask      = held_functions;
    const auto  for_owned = [&](const auto &visit) {
      for (unsigned int k = 0; k < fields.size(); ++k)
        for (unsigned int c = 0; c < dim; ++c)
          if (component_has_held[c])
            for (unsigned int f = 0; f < n_owned_functions(); ++f)
              if (((mask[f] >> c) & 1) &&
                  (*extension)[f] != Extension<dim>::inactive)
                visit(k, c, f);
    };
    for_owned([&](const unsigned int k, const unsigned int c, unsigned int f) {
      any = any || (*fields[k])[c].local_element(f) != 0.;
    });
    // Walls at rest contribute nothing.
    if (Utilities::MPI::max<unsigned int>(any, communicator()) == 0)
      return;

    VectorType x, y;
    initialize_vector(x, width);
    initialize_vector(y, width);
    for_owned([&](const unsigned int k, const unsigned int c, unsigned int f) {
      const int role = roles[points_mass.place(f)];
      if (role > 0)
        x.local_element((role - 1) * width + k * dim + c) =
          (*fields[k])[c].local_element(f);
    });
    x.update_ghost_values();
    expand(x.begin(), width);
    for (unsigned int k = 0; k < fields.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        {
          VectorType &field = (*fields[k])[c];
          field.update_ghost_values();
          for (unsigned int f = 0; f < held_functions.size(); ++f)
            if (((mask[f] >> c) & 1) &&
                (*extension)[f] != Extension<dim>::inactive)
              place_x[std::size_t(points_mass.place(f)) * width + k * dim + c] =
                field.local_element(f);
          field.zero_out_ghost_values();
        }
    points_mass.vmult(place_y.data(), place_x.data(), width);
    zero_held(place_y.data(), width);
    collect(y.begin(), width);
    y.compress(VectorOperation::add);
    for (std::size_t i = 0; i < std::size_t(n_owned) * width; ++i)
      rows.local_element(i) -= y.local_element(i);
    zero_held_unknowns(rows, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::to_places(const VectorType &component) const
  {
    component.update_ghost_values();
    for (unsigned int f = 0; f < held_functions.size(); ++f)
      if ((*extension)[f] != Extension<dim>::inactive)
        place_x[points_mass.place(f)] = component.local_element(f);
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
        for (unsigned int f = 0; f < held_functions.size(); ++f)
          if (((held_functions[f] >> c) & 1) &&
              (*extension)[f] != Extension<dim>::inactive)
            {
              double sum = 0.;
              points_mass.for_each_entry(points_mass.place(f),
                                         [&](const unsigned int j,
                                             const double       value) {
                                           sum += value * place_x[j];
                                         });
              rows[c].local_element(f) = sum;
            }
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



  template void
  ExtendedMass<2>::condense(VectorType &, const VectorType &) const;
  template void
  ExtendedMass<2>::distribute(VectorType &, VectorType &) const;
  template void
  ExtendedMass<3>::condense(VectorType &, const VectorType &) const;
  template void
  ExtendedMass<3>::distribute(VectorType &, VectorType &) const;
  template void
  ExtendedMass<2>::restrict_fields(VectorType &,
                                   const std::vector<const VectorField<2> *> &,
                                   const unsigned int) const;
  template void
  ExtendedMass<2>::read_fields(VectorType &,
                               const std::vector<const VectorField<2> *> &,
                               const unsigned int) const;
  template void
  ExtendedMass<2>::write_fields(const std::vector<VectorField<2> *> &,
                                VectorType &,
                                const unsigned int) const;
  template void
  ExtendedMass<2>::subtract_held(VectorType &,
                                 const std::vector<VectorField<2> *> &,
                                 const unsigned int) const;
  template void
  ExtendedMass<2>::multiply_field(VectorField<2> &,
                                  const VectorField<2> &) const;
  template void
  ExtendedMass<2>::multiply_at_held(VectorField<2> &,
                                    const VectorField<2> &) const;
  template void
  ExtendedMass<2>::approximate_diagonal(VectorType &) const;
  template void
  ExtendedMass<2>::extend(VectorField<2> &, const VectorType &) const;

  template void
  ExtendedMass<3>::restrict_fields(VectorType &,
                                   const std::vector<const VectorField<3> *> &,
                                   const unsigned int) const;
  template void
  ExtendedMass<3>::read_fields(VectorType &,
                               const std::vector<const VectorField<3> *> &,
                               const unsigned int) const;
  template void
  ExtendedMass<3>::write_fields(const std::vector<VectorField<3> *> &,
                                VectorType &,
                                const unsigned int) const;
  template void
  ExtendedMass<3>::subtract_held(VectorType &,
                                 const std::vector<VectorField<3> *> &,
                                 const unsigned int) const;
  template void
  ExtendedMass<3>::multiply_field(VectorField<3> &,
                                  const VectorField<3> &) const;
  template void
  ExtendedMass<3>::multiply_at_held(VectorField<3> &,
                                    const VectorField<3> &) const;
  template void
  ExtendedMass<3>::approximate_diagonal(VectorType &) const;
  template void
  ExtendedMass<3>::extend(VectorField<3> &, const VectorType &) const;
} // namespace greville

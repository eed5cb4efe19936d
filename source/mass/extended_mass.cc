// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/extended_mass.h>

#include <algorithm>

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
    // If points lie only at the outer edge of a function's support, its mass is
    // round-off.
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
    unsigned int any = 0;
    for_each_constrained(false,
                         [&](const unsigned int,
                             const std::size_t,
                             const double value) { any |= value != 0.; });
    // Walls at rest contribute nothing.
    if (Utilities::MPI::max(any, E->communicator()) == 0)
      return;
    VectorType x, y;
    E->initialize_vector(x, width);
    for_each_constrained(
      false,
      [&](const unsigned int c, const std::size_t place, const double value) {
        if (E->signed_numbers[place] > 0)
          x.local_element((E->signed_numbers[place] - 1) * width + c) = value;
      });

    x.update_ghost_values();
    E->expand(x.begin(), width, E->place_x.data());
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
    E->collect(y.begin(), width, E->place_y.data());
    y.compress(VectorOperation::add);
    rows.add(-1., y);
    E->zero_constrained_unknowns(rows, width);
  }



  template <int dim>
  void
  ExtendedMass<dim>::multiply_field(VectorType             &rows,
                                    const VectorField<dim> &field) const
  {
    for (const VectorType &component : field)
      component.update_ghost_values();
    E->for_each_active_place(
      [&](const unsigned int f, const std::size_t place) {
        for (unsigned int c = 0; c < dim; ++c)
          E->place_x[place * dim + c] = field[c].local_element(f);
      });
    for (const VectorType &component : field)
      component.zero_out_ghost_values();
    points_mass.vmult(E->place_y.data(), E->place_x.data(), dim);
    E->zero_constrained(E->place_y.data(), dim);
    E->initialize_vector(rows, dim);
    E->collect(rows.begin(), dim, E->place_y.data());
    rows.compress(VectorOperation::add);
    E->zero_constrained_unknowns(rows, dim);
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



  GREVILLE_INSTANTIATE_CLASS(ExtendedMass);
} // namespace greville

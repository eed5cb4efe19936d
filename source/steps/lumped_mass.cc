// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/fmpm.h>
#include <greville/steps/lumped_mass.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Surfaces ignore functions if each cell of their support is filled by less
    // than this fraction.
    constexpr double smallest_filling = 0.1;
  } // namespace



  template <int dim>
  LumpedMass<dim>::LumpedMass(const unsigned int         n_terms,
                              const OrderHierarchy<dim> &orders,
                              const Walls<dim>          &walls)
    : GridMass<dim>(orders, walls)
    , n_terms(n_terms)
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      friction_walls[w] = walls.is_friction(w);
    for (VectorType &component : inverse)
      this->space().initialize_vector(component);
    if (this->space().hierarchy())
      levels = std::make_unique<Levels>(this->space());
  }



  template <int dim>
  LumpedMass<dim>::Levels::Levels(const SplineSpace<dim> &space)
  {
    const unsigned int n_cells = space.owned_cells().size();
    filling.reinit(space);
    filling.update(std::vector<double>(n_cells, 1.), 0.);
    extension.reinit(space, filling);
    places.reinit(space);
    unknowns.reinit(places);
    unknowns.update(extension, true);
    for (unsigned int f = 0; f < space.owned_functions().size(); ++f)
      {
        is_tied.push_back(extension[f] == Extension<dim>::extended);
        greville_points.push_back(space.greville_point(f));
      }
    for (unsigned int cell = 0; cell < n_cells; ++cell)
      {
        const auto functions = space.cell_functions(cell);
        has_tied.push_back(std::any_of(
          functions.begin(), functions.end(), [&](const unsigned int f) {
            return extension[f] == Extension<dim>::extended;
          }));
      }
  }



  template <int dim>
  void
  LumpedMass<dim>::condense_levels(VectorField<dim> &rows) const
  {
    for (unsigned int c = 0; c < dim && levels; ++c)
      levels->unknowns.condense(rows[c], c);
  }



  template <int dim>
  void
  LumpedMass<dim>::condense_levels(
    VectorType                                     &lumped,
    VectorField<dim>                               &momentum,
    const std::vector<const MaterialPoints<dim> *> &bodies,
    PointTransfer<dim>                             &transfer) const
  {
    if (!levels)
      return;
    levels->unknowns.condense(lumped, 0);
    condense_levels(momentum);
    if (std::none_of(bodies.begin(), bodies.end(), [](const auto *points) {
          return points->layout().find("affine");
        }))
      return;
    // Affine velocities of a tied function k with the sum Q_k of m N_k C refer
    // to its Greville point. For another function i, E_ki Q_k (xi_i - xi_k) is
    // missing.
    VectorField<dim> sums, moments;
    for (auto *field : {&sums, &moments})
      for (VectorType &component : *field)
        this->space().initialize_vector(component);
    const unsigned int n_owned = levels->is_tied.size();
    const auto        &places  = levels->greville_points;
    for (unsigned int column = 0; column < dim; ++column)
      {
        transfer.affine_momentum(bodies, column, levels->has_tied, sums);
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int i = 0; i < n_owned; ++i)
            {
              double &sum                 = sums[c].local_element(i);
              sum                         = levels->is_tied[i] ? sum : 0.;
              moments[c].local_element(i) = places[i][column] * sum;
            }
        condense_levels(sums);
        condense_levels(moments);
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int i = 0; i < n_owned; ++i)
            momentum[c].local_element(i) +=
              places[i][column] * sums[c].local_element(i) -
              moments[c].local_element(i);
      }
  }



  template <int dim>
  void
  LumpedMass<dim>::distribute_levels(VectorField<dim> &x) const
  {
    for (unsigned int c = 0; c < dim && levels; ++c)
      levels->unknowns.distribute(x[c], c);
  }



  template <int dim>
  void
  LumpedMass<dim>::update(
    const VectorType                               &lumped,
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const std::vector<const MaterialPoints<dim> *> &surfaces,
    const PointTransfer<dim>                       &transfer)
  {
    this->lumped_mass.copy_locally_owned_data_from(lumped);
    update_constrained();
    extend_to(surfaces, bodies, transfer);
    if (n_terms == 1)
      return;
    if (!product)
      {
        weights.emplace(this->space(), 2 * this->space().degree() + 1);
        product = std::make_unique<CrossMassOperator<dim>>(this->space(),
                                                           this->space(),
                                                           *weights);
      }
    transfer.mass_weights(bodies, *weights);
  }



  template <int dim>
  void
  LumpedMass<dim>::extend_to(
    const std::vector<const MaterialPoints<dim> *> &surfaces,
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const PointTransfer<dim>                       &transfer)
  {
    const auto is_ahead = [](const MaterialPoints<dim> *points) {
      return points->layout().find("gap") && !points->layout().find("radius");
    };
    if (std::none_of(surfaces.begin(), surfaces.end(), is_ahead))
      {
        extended.reset();
        return;
      }
    const bool is_new = !extended;
    if (is_new)
      {
        extended = std::make_unique<Extended>();
        extended->filling.reinit(this->space(), friction_walls);
        extended->stencil.reinit(this->space());
        extended->unknowns.reinit(extended->stencil);
      }
    transfer.filling(bodies, extended->filled_part);
    // For surfaces, hardly filled cells also count as outside of the body.
    std::vector<double> &filled_part = extended->filled_part;
    for (double &part : filled_part)
      part = part < smallest_filling ? -part : part;
    for (const MaterialPoints<dim> *points : surfaces)
      for (const unsigned int cell : points->cells())
        if (filled_part[cell] == 0.)
          filled_part[cell] = -1.;
    // The threshold 0 makes all other cells with points hosts.
    const bool has_changed = extended->filling.update(filled_part, 0.);
    if (has_changed)
      extended->extension.reinit(this->space(), extended->filling, true);
    extended->unknowns.update(extended->extension, is_new || has_changed);
  }



  template <int dim>
  template <typename Action>
  void
  LumpedMass<dim>::for_each_constrained(const unsigned int component,
                                        Action             action) const
  {
    for (unsigned int i = 0; i < this->lumped_mass.locally_owned_size(); ++i)
      if ((this->wall_constrained[i] >> component) & 1)
        action(i);
  }



  template <int dim>
  void
  LumpedMass<dim>::condense(VectorField<dim> &rows) const
  {
    for (unsigned int c = 0; c < dim && extended; ++c)
      {
        std::vector<double> kept;
        for_each_constrained(c, [&](const unsigned int i) {
          kept.push_back(rows[c].local_element(i));
          rows[c].local_element(i) = 0.;
        });
        extended->unknowns.condense(rows[c], c);
        for_each_constrained(c, [&, k = 0u](const unsigned int i) mutable {
          rows[c].local_element(i) += kept[k++];
        });
      }
  }



  template <int dim>
  void
  LumpedMass<dim>::distribute(VectorField<dim> &x) const
  {
    for (unsigned int c = 0; c < dim && extended; ++c)
      {
        std::vector<double> kept;
        for_each_constrained(c, [&](const unsigned int i) {
          kept.push_back(x[c].local_element(i));
        });
        extended->unknowns.distribute(x[c], c);
        for_each_constrained(c, [&, k = 0u](const unsigned int i) mutable {
          x[c].local_element(i) = kept[k++];
        });
      }
  }



  template <int dim>
  void
  LumpedMass<dim>::update_constrained()
  {
    for (unsigned int i = 0; i < this->lumped_mass.locally_owned_size(); ++i)
      {
        const double m = this->lumped_mass.local_element(i);
        const double f = m > 0. ? 1. / m : 0.;
        for (unsigned int c = 0; c < dim; ++c)
          inverse[c].local_element(i) =
            (this->constrained[i] >> c) & 1 ? 0. : f;
      }
  }



  template <int dim>
  void
  LumpedMass<dim>::solve(const std::vector<VectorField<dim> *>       &x,
                         const std::vector<const VectorField<dim> *> &b,
                         const std::vector<double> &)
  {
    AssertThrow(x.size() == b.size(), ExcDimensionMismatch(x.size(), b.size()));
    if (n_terms > 1)
      products.resize(x.size());
    for (unsigned int k = 0; k < x.size(); ++k)
      {
        given.clear();
        for (const auto &at : this->oblique)
          given.push_back(at.part_along(values_at<dim>(*x[k], at.function)));
        for (unsigned int c = 0; c < dim; ++c)
          {
            VectorType       &solution = (*x[k])[c];
            const VectorType &rows     = (*b[k])[c];
            for (unsigned int i = 0; i < rows.locally_owned_size(); ++i)
              if (!((this->constrained[i] >> c) & 1))
                solution.local_element(i) =
                  inverse[c].local_element(i) * rows.local_element(i);
            if (n_terms > 1)
              products[k][c] =
                add_fmpm_terms(solution, rows, *product, inverse[c], n_terms);
          }
        for (unsigned int o = 0; o < given.size(); ++o)
          {
            const auto          &at = this->oblique[o];
            const Tensor<1, dim> change =
              given[o] - at.part_along(values_at<dim>(*x[k], at.function));
            for (unsigned int c = 0; c < dim; ++c)
              (*x[k])[c].local_element(at.function) += change[c];
          }
        distribute_levels(*x[k]);
      }
  }



  template <int dim>
  void
  LumpedMass<dim>::constrained_rows(VectorField<dim>       &rows,
                                    const VectorField<dim> &x,
                                    const VectorField<dim> &b,
                                    const unsigned int      k) const
  {
    for (unsigned int i = 0; i < this->lumped_mass.locally_owned_size(); ++i)
      for (unsigned int c = 0; c < dim && this->constrained[i] != 0; ++c)
        if ((this->constrained[i] >> c) & 1)
          rows[c].local_element(i) =
            (n_terms > 1
               ? products[k][c].local_element(i)
               : this->lumped_mass.local_element(i) * x[c].local_element(i)) -
            b[c].local_element(i);
    for (const auto &at : this->oblique)
      {
        const unsigned int   i   = at.function;
        const Tensor<1, dim> row = at.part_along(
          this->lumped_mass.local_element(i) * values_at<dim>(x, i) -
          values_at<dim>(b, i));
        for (unsigned int c = 0; c < dim; ++c)
          if (!((this->constrained[i] >> c) & 1))
            rows[c].local_element(i) = row[c];
      }
  }



  template <int dim>
  void
  LumpedMass<dim>::multiply_constrained_rows(
    VectorField<dim>            &rows,
    const VectorField<dim>      &x,
    const std::array<bool, dim> &components) const
  {
    for (unsigned int c = 0; c < dim; ++c)
      if (components[c] && n_terms > 1)
        product->vmult(rows[c], x[c]);
      else if (components[c])
        for (unsigned int i = 0; i < x[c].locally_owned_size(); ++i)
          rows[c].local_element(i) =
            this->lumped_mass.local_element(i) * x[c].local_element(i);
  }



  GREVILLE_INSTANTIATE_CLASS(LumpedMass);
} // namespace greville

#include <greville/simulation/grid_mass.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  GridMass<dim>::GridMass(const std::string             &mass,
                          const unsigned int             degree,
                          DistributedTriangulation<dim> &triangulation,
                          const SimulationParameters    &parameters,
                          const Walls<dim>              &walls)
    : fmpm_order(MassSolver<dim>::fmpm_order_of(mass))
    , solver_name(mass == "consistent" ? "cg-p-multigrid"
                  : fmpm_order == 1    ? "lumped"
                                       : mass)
    , parameters(parameters)
    , walls(walls)
    , orders(triangulation, degree, parameters.multigrid.coarsening)
    , product_weights(space(), 2 * degree + 1)
  {
    space().initialize_vector(lumped_mass);
    space().initialize_vector(inverse_lumped);
    for (unsigned int c = 0; c < dim; ++c)
      {
        space().initialize_vector(is_free[c]);
        is_free[c]             = 1.;
        const Constraints held = walls.constraints(space(), c);
        for (const auto &line : held.get_lines())
          is_free[c](line.index) = 0.;
      }
    if (fmpm_order == 0)
      make_groups();
  }



  template <int dim>
  void
  GridMass<dim>::make_groups()
  {
    for (unsigned int c = 0; c < dim; ++c)
      {
        bool found = false;
        for (Group &group : groups)
          if (!found && walls.hold_the_same(c, group.components[0]))
            {
              group.components.push_back(c);
              found = true;
            }
        if (found)
          continue;
        Group group;
        group.components = {c};
        std::vector<unsigned int> n_points;
        for (unsigned int l = 0; l < orders.n_levels(); ++l)
          n_points.push_back(2 * orders[l].degree() + 1);
        group.mass = std::make_unique<MassHierarchy<dim>>(orders, n_points);
        const auto levels = group.mass->all_levels();
        for (unsigned int l = 0; l < levels.size(); ++l)
          levels[l]->constrain(walls.constraints(orders[l], c));
        group.solver = std::make_unique<MassSolver<dim>>(solver_name,
                                                         *group.mass,
                                                         parameters.solver,
                                                         parameters.multigrid,
                                                         parameters.smoother);
        groups.push_back(std::move(group));
      }
  }



  template <int dim>
  void
  GridMass<dim>::prepare_product(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const PointTransfer<dim>                       &transfer)
  {
    transfer.mass_weights(bodies, product_weights);
    if (!product)
      product = std::make_unique<CrossMassOperator<dim>>(space(),
                                                         space(),
                                                         product_weights);
  }



  template <int dim>
  void
  GridMass<dim>::update(const VectorType                               &lumped,
                        const std::vector<const MaterialPoints<dim> *> &bodies,
                        const PointTransfer<dim> &transfer)
  {
    lumped_mass.copy_locally_owned_data_from(lumped);
    for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
      {
        const double m                  = lumped.local_element(i);
        inverse_lumped.local_element(i) = m > 0. ? 1. / m : 0.;
      }
    if (fmpm_order > 1 || (fmpm_order == 0 && walls.move()))
      prepare_product(bodies, transfer);

    const bool with_levels = MassSolver<dim>::uses_multigrid(solver_name);
    for (unsigned int k = 0; k < groups.size(); ++k)
      {
        const auto levels = groups[k].mass->all_levels();
        for (unsigned int l = 0; l < levels.size(); ++l)
          if (l + 1 == levels.size() || with_levels)
            {
              if (k == 0)
                transfer.mass_weights(bodies, levels[l]->weights());
              else
                levels[l]->weights() =
                  groups[0].mass->all_levels()[l]->weights();
            }
        groups[k].solver->assemble();
        groups[k].solver->setup();
      }
  }



  template <int dim>
  void
  GridMass<dim>::multiply(VectorField<dim> &b, const VectorField<dim> &x) const
  {
    for (unsigned int c = 0; c < dim; ++c)
      {
        product->vmult(b[c], x[c]);
        b[c].scale(is_free[c]);
      }
  }



  template <int dim>
  void
  GridMass<dim>::solve(VectorField<dim> &x, const VectorField<dim> &b)
  {
    iterations = 0;
    if (fmpm_order > 0)
      solve_series(x, b);
    else
      for (const Group &group : groups)
        for (const unsigned int c : group.components)
          solve_component(group, x[c], b[c]);
  }



  template <int dim>
  void
  GridMass<dim>::solve_series(VectorField<dim>       &x,
                              const VectorField<dim> &b) const
  {
    VectorType term, multiplied;
    if (fmpm_order > 1)
      {
        space().initialize_vector(term);
        space().initialize_vector(multiplied);
      }
    for (unsigned int c = 0; c < dim; ++c)
      {
        // The first term, and what is held.
        const VectorType &free = is_free[c];
        if (fmpm_order > 1)
          {
            for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
              term.local_element(i) =
                (1. - free.local_element(i)) * x[c].local_element(i);
            if (walls.move())
              product->vmult(multiplied, term);
            for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
              term.local_element(i) =
                free.local_element(i) * inverse_lumped.local_element(i) *
                (b[c].local_element(i) -
                 (walls.move() ? multiplied.local_element(i) : 0.));
            for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
              x[c].local_element(i) =
                (1. - free.local_element(i)) * x[c].local_element(i) +
                term.local_element(i);
          }
        else
          for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
            x[c].local_element(i) =
              free.local_element(i) * inverse_lumped.local_element(i) *
                b[c].local_element(i) +
              (1. - free.local_element(i)) * x[c].local_element(i);

        for (unsigned int j = 1; j < fmpm_order; ++j)
          {
            product->vmult(multiplied, term);
            multiplied.scale(inverse_lumped);
            multiplied.scale(free);
            term -= multiplied;
            x[c] += term;
          }
      }
  }



  template <int dim>
  void
  GridMass<dim>::solve_component(const Group      &group,
                                 VectorType       &x,
                                 const VectorType &b)
  {
    VectorType right_hand_side, solution, held;
    for (VectorType *vector : {&right_hand_side, &solution, &held})
      space().initialize_vector(*vector);
    const auto &inactive = group.mass->finest().mass().inactive();
    right_hand_side.copy_locally_owned_data_from(b);
    for (const unsigned int i : inactive)
      held.local_element(i) = x.local_element(i);
    if (walls.move())
      {
        product->vmult(solution, held);
        right_hand_side -= solution;
      }
    for (const unsigned int i : inactive)
      right_hand_side.local_element(i) = 0.;
    const SolveResult result = group.solver->solve(solution, right_hand_side);
    // What does not iterate is not meant to reach a tolerance.
    AssertThrow(!result.iterations || result.converged,
                ExcMessage("The solver <" + solver_name +
                           "> of the mass matrix failed: it " + result.reason +
                           ". Consistent mass needs a body that fills the "
                           "cells that it touches; free surfaces and lumped "
                           "mass go together (see doc/simulation.md)."));
    if (result.iterations)
      iterations = std::max(iterations, *result.iterations);
    x.copy_locally_owned_data_from(solution);
    for (const unsigned int i : inactive)
      x.local_element(i) = held.local_element(i);
  }



  template <int dim>
  std::uint64_t
  GridMass<dim>::n_active() const
  {
    std::uint64_t n = 0;
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      n += lumped_mass.local_element(i) > 0.;
    return Utilities::MPI::sum(n, space().communicator());
  }



  template class GridMass<2>;
  template class GridMass<3>;
} // namespace greville

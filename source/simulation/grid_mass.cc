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
    , solver_name(mass != "consistent" ? (fmpm_order == 1 ? "lumped" : mass)
                  : parameters.multigrid.coarsening == "auto"
                    ? "cg-ic0"
                    : "cg-p-multigrid")
    , parameters(parameters)
    , walls(walls)
    , orders(triangulation, degree, parameters.multigrid.coarsening)
    , held(space().owned_functions().size() + space().ghost_functions().size())
  {
    space().initialize_vector(lumped_mass);
    space().initialize_vector(inverse_lumped);
    for (unsigned int c = 0; c < dim; ++c)
      {
        space().initialize_vector(is_free[c]);
        is_free[c]                = 1.;
        const Constraints at_wall = walls.constraints(space(), c);
        for (const auto &line : at_wall.get_lines())
          is_free[c](line.index) = 0.;
        is_free[c].update_ghost_values();
        for (unsigned int f = 0; f < held.size(); ++f)
          if (is_free[c].local_element(f) == 0.)
            held[f] |= 1 << c;
        is_free[c].zero_out_ghost_values();
      }
    wall_held = held;
    if (fmpm_order > 0)
      return;
    typename CellFilling<dim>::Walls contact_walls;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      contact_walls[w] = walls.is_friction(w);
    filling.reinit(space(), contact_walls);
    extensions.resize(orders.n_levels());
    extended_mass.reinit(space());
    if (solver_name == "cg-ic0")
      solver_of_all =
        std::make_unique<ExtendedMassSolver<dim>>(extended_mass,
                                                  parameters.solver,
                                                  parameters.smoother);
    else
      make_groups();
    if (walls.have_friction())
      solver_of_held =
        std::make_unique<ExtendedMassSolver<dim>>(extended_mass,
                                                  parameters.solver,
                                                  parameters.smoother);
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
        group.mass   = std::make_unique<MassHierarchy<dim>>(orders, n_points);
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
    if (!product_weights)
      product_weights.emplace(space(), 2 * space().degree() + 1);
    transfer.mass_weights(bodies, *product_weights);
    if (!product)
      product = std::make_unique<CrossMassOperator<dim>>(space(),
                                                         space(),
                                                         *product_weights);
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
    if (fmpm_order > 1)
      prepare_product(bodies, transfer);

    if (fmpm_order > 0)
      return;
    const bool unknowns_changed = update_extensions(bodies, transfer);
    extended_mass.begin(extension(), unknowns_changed);
    if (unknowns_changed)
      extended_mass.hold(held);
    held_solver_is_behind = held_solver_is_behind || unknowns_changed;
    transfer.add_mass_matrix(bodies, extended_mass.matrix());
    extended_mass.finish();
    total_mass = 0.;
    for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
      total_mass += lumped.local_element(i);
    total_mass = Utilities::MPI::sum(total_mass, space().communicator());
    if (solver_of_all)
      solver_of_all->update(unknowns_changed, total_mass);
    else
      update_groups(bodies, transfer, unknowns_changed);
  }



  template <int dim>
  bool
  GridMass<dim>::update_extensions(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const PointTransfer<dim>                       &transfer)
  {
    transfer.filling(bodies, filled_part);
    if (!filling.update(filled_part, parameters.scheme.filling))
      return false;
    for (unsigned int l = 0; l < extensions.size(); ++l)
      if (l + 1 == extensions.size() || !solver_of_all)
        extensions[l].reinit(orders[l], filling);
    return true;
  }



  template <int dim>
  void
  GridMass<dim>::update_groups(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const PointTransfer<dim>                       &transfer,
    const bool                                      unknowns_changed)
  {
    const bool with_levels = MassSolver<dim>::uses_multigrid(solver_name);
    for (unsigned int k = 0; k < groups.size(); ++k)
      {
        const auto levels = groups[k].mass->all_levels();
        for (unsigned int l = 0; l < levels.size(); ++l)
          if (l + 1 == levels.size() || with_levels)
            {
              if (unknowns_changed)
                levels[l]->constrain(walls.constraints(orders[l],
                                                       groups[k].components[0]),
                                     extensions[l]);
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
  GridMass<dim>::solve(const std::vector<VectorField<dim> *>       &x,
                       const std::vector<const VectorField<dim> *> &b,
                       const std::vector<double>                   &shares)
  {
    AssertDimension(x.size(), b.size());
    iterations = 0;
    if (fmpm_order > 0)
      {
        for (unsigned int k = 0; k < x.size(); ++k)
          solve_series(*x[k], *b[k]);
        return;
      }
    check(solver_of_all ? solver_of_all->solve(x, b, shares)
                        : solve_components(x, b));
  }



  template <int dim>
  void
  GridMass<dim>::check(const SolveResult &result)
  {
    // What does not iterate is not meant to reach a tolerance.
    AssertThrow(!result.iterations || result.converged,
                ExcMessage("The solver <" + solver_name +
                           "> of the mass matrix failed: it " + result.reason +
                           ". The matrix is singular where a body has fewer "
                           "points across it than functions of 'Grid/Order' "
                           "see it: look at 'Points per direction'."));
    iterations = result.iterations.value_or(0);
  }



  template <int dim>
  std::vector<unsigned char>
  GridMass<dim>::for_local_functions(
    const std::vector<unsigned char> &owned) const
  {
    VectorType bits;
    space().initialize_vector(bits);
    for (unsigned int i = 0; i < owned.size(); ++i)
      bits.local_element(i) = owned[i];
    bits.update_ghost_values();
    std::vector<unsigned char> result(held.size());
    for (unsigned int f = 0; f < result.size(); ++f)
      result[f] = static_cast<unsigned char>(bits.local_element(f));
    return result;
  }



  template <int dim>
  void
  GridMass<dim>::hold(const std::vector<unsigned char> &more)
  {
    AssertThrow(groups.empty(),
                ExcMessage("Bodies with an imposed velocity go with "
                           "'Scheme/Mass' = lumped, fmpm-K or consistent (with "
                           "'Multigrid/Coarsening' = auto), not with the "
                           "solver <" +
                           solver_name + ">."));
    std::vector<unsigned char> now = for_local_functions(more);
    for (unsigned int f = 0; f < now.size(); ++f)
      now[f] |= wall_held[f];
    const bool has_changed =
      Utilities::MPI::max<unsigned int>(now != held, space().communicator());
    if (!has_changed)
      return;
    held = now;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int i = 0; i < is_free[c].locally_owned_size(); ++i)
        is_free[c].local_element(i) = 1. - ((held[i] >> c) & 1);
    if (is_consistent())
      extended_mass.hold(held);
  }



  template <int dim>
  std::array<bool, dim>
  GridMass<dim>::held_meet_mass() const
  {
    unsigned int found[dim] = {};
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      if (held[i] != 0 && lumped_mass.local_element(i) > 0.)
        for (unsigned int c = 0; c < dim; ++c)
          found[c] |= (held[i] >> c) & 1;
    Utilities::MPI::max(ArrayView<const unsigned int>(found, dim),
                        space().communicator(),
                        ArrayView<unsigned int>(found, dim));
    std::array<bool, dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      result[c] = found[c] != 0;
    return result;
  }



  template <int dim>
  void
  GridMass<dim>::held_residual(VectorField<dim>       &residual,
                               const VectorField<dim> &b,
                               const VectorField<dim> &x) const
  {
    if (is_consistent())
      extended_mass.multiply_at_held(residual, x);
    const auto meets_mass = held_meet_mass();
    for (unsigned int c = 0; c < dim; ++c)
      {
        if (!meets_mass[c])
          {
            residual[c] = 0.;
            continue;
          }
        if (fmpm_order > 1)
          product->vmult(residual[c], x[c]);
        for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
          {
            const double m = lumped_mass.local_element(i);
            double      &r = residual[c].local_element(i);
            if (!((held[i] >> c) & 1) || !(m > 0.))
              r = 0.;
            else if (is_lumped())
              r = b[c].local_element(i) / m - x[c].local_element(i);
            else
              r = (b[c].local_element(i) - r) / m;
          }
      }
  }



  template <int dim>
  void
  GridMass<dim>::solve_held(VectorField<dim>                 &x,
                            const VectorField<dim>           &b,
                            const std::vector<unsigned char> &more)
  {
    Assert(solver_of_held, ExcMessage("There are no friction walls."));
    std::vector<unsigned char> all_held = for_local_functions(more);
    for (unsigned int f = 0; f < all_held.size(); ++f)
      all_held[f] |= held[f];

    extended_mass.hold(all_held);
    solver_of_held->update(held_solver_is_behind, total_mass);
    held_solver_is_behind    = false;
    const SolveResult result = solver_of_held->solve({&x}, {&b});
    extended_mass.hold(held);
    check(result);
  }



  template <int dim>
  void
  GridMass<dim>::solve_series(VectorField<dim>       &x,
                              const VectorField<dim> &b) const
  {
    // Of the whole field, so that what is held takes part with its values:
    // x <- x + M_L^-1 (b - M x) where it is free.
    VectorType multiplied;
    if (fmpm_order > 1)
      space().initialize_vector(multiplied);
    for (unsigned int c = 0; c < dim; ++c)
      {
        const VectorType &free = is_free[c];
        for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
          x[c].local_element(i) =
            free.local_element(i) * inverse_lumped.local_element(i) *
              b[c].local_element(i) +
            (1. - free.local_element(i)) * x[c].local_element(i);
        for (unsigned int j = 1; j < fmpm_order; ++j)
          {
            product->vmult(multiplied, x[c]);
            for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
              x[c].local_element(i) +=
                free.local_element(i) * inverse_lumped.local_element(i) *
                (b[c].local_element(i) - multiplied.local_element(i));
          }
      }
  }



  template <int dim>
  SolveResult
  GridMass<dim>::solve_components(
    const std::vector<VectorField<dim> *>       &x,
    const std::vector<const VectorField<dim> *> &b)
  {
    // The solvers of the groups start from zero, and have the unknowns where
    // the space has them.
    constexpr unsigned int width = 4;
    VectorType             unknowns, rows, full, full_rows;
    extended_mass.initialize_vector(unknowns, width);
    extended_mass.initialize_vector(rows, width);
    space().initialize_vector(full);
    space().initialize_vector(full_rows);
    const auto &functions = extended_mass.unknown_functions();

    SolveResult result;
    result.converged = true;
    for (unsigned int k = 0; k < x.size(); ++k)
      {
        extended_mass.restrict_fields(rows, {b[k]}, width);
        extended_mass.subtract_held(rows, {x[k]}, width);
        for (const Group &group : groups)
          for (const unsigned int c : group.components)
            {
              full_rows = 0.;
              for (unsigned int u = 0; u < functions.size(); ++u)
                full_rows.local_element(functions[u]) =
                  rows.local_element(u * width + c);
              const SolveResult part = group.solver->solve(full, full_rows);
              for (unsigned int u = 0; u < functions.size(); ++u)
                unknowns.local_element(u * width + c) =
                  full.local_element(functions[u]);
              if (part.iterations)
                result.iterations =
                  std::max(result.iterations.value_or(0), *part.iterations);
              if (!part.converged)
                {
                  result.converged = false;
                  result.reason    = part.reason;
                }
            }
        extended_mass.write_fields({x[k]}, unknowns, width);
      }
    return result;
  }



  template <int dim>
  double
  GridMass<dim>::fragment_fraction() const
  {
    std::uint64_t n = 0;
    for (const double part : filled_part)
      n += part > 0.;
    n = Utilities::MPI::sum(n, space().communicator());
    return n > 0 ? double(n_fragments()) / n : 0.;
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

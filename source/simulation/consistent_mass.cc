#include <greville/simulation/consistent_mass.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  ConsistentMass<dim>::ConsistentMass(
    const unsigned int             degree,
    DistributedTriangulation<dim> &triangulation,
    const SimulationParameters    &parameters,
    const Walls<dim>              &walls)
    : GridMass<dim>(degree,
                    triangulation,
                    parameters.solver.method == "cg-p-multigrid"
                      ? parameters.multigrid.coarsening
                      : "none",
                    walls)
    , parameters(parameters)
    , walls(walls)
    , extensions(this->orders.n_levels())
  {
    typename CellFilling<dim>::Walls contact_walls;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      contact_walls[w] = walls.is_friction(w);
    filling.reinit(this->space(), contact_walls);
    extended_mass.reinit(this->space());
    if (parameters.solver.method == "cg-ic0")
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
  ConsistentMass<dim>::make_groups()
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
        for (unsigned int l = 0; l < this->orders.n_levels(); ++l)
          n_points.push_back(2 * this->orders[l].degree() + 1);
        group.mass =
          std::make_unique<MassHierarchy<dim>>(this->orders, n_points);
        group.solver =
          std::make_unique<MassSolver<dim>>(parameters.solver.method,
                                            *group.mass,
                                            parameters.solver,
                                            parameters.multigrid,
                                            parameters.smoother);
        groups.push_back(std::move(group));
      }
  }



  template <int dim>
  void
  ConsistentMass<dim>::update(
    const VectorType                               &lumped,
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const PointTransfer<dim>                       &transfer)
  {
    this->lumped_mass.copy_locally_owned_data_from(lumped);
    const bool unknowns_changed = update_extensions(bodies, transfer);
    extended_mass.begin(extension(), unknowns_changed);
    if (unknowns_changed)
      extended_mass.hold(this->held);
    held_solver_is_behind = held_solver_is_behind || unknowns_changed;
    transfer.add_mass_matrix(bodies, extended_mass.matrix());
    extended_mass.finish();
    total_mass = 0.;
    for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
      total_mass += lumped.local_element(i);
    total_mass = Utilities::MPI::sum(total_mass, this->space().communicator());
    if (solver_of_all)
      solver_of_all->update(unknowns_changed, total_mass);
    else
      update_groups(bodies, transfer, unknowns_changed);
  }



  template <int dim>
  bool
  ConsistentMass<dim>::update_extensions(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const PointTransfer<dim>                       &transfer)
  {
    transfer.filling(bodies, filled_part);
    if (!filling.update(filled_part, parameters.scheme.filling))
      return false;
    for (unsigned int l = 0; l < extensions.size(); ++l)
      if (l + 1 == extensions.size() || !solver_of_all)
        extensions[l].reinit(this->orders[l], filling);
    return true;
  }



  template <int dim>
  void
  ConsistentMass<dim>::update_groups(
    const std::vector<const MaterialPoints<dim> *> &bodies,
    const PointTransfer<dim>                       &transfer,
    const bool                                      unknowns_changed)
  {
    const bool with_levels =
      MassSolver<dim>::uses_multigrid(parameters.solver.method);
    for (unsigned int k = 0; k < groups.size(); ++k)
      {
        const auto levels = groups[k].mass->all_levels();
        for (unsigned int l = 0; l < levels.size(); ++l)
          if (l + 1 == levels.size() || with_levels)
            {
              if (unknowns_changed)
                levels[l]->constrain(walls.constraints(this->orders[l],
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
  ConsistentMass<dim>::change_held()
  {
    AssertThrow(groups.empty(),
                ExcMessage("Bodies with an imposed velocity go with "
                           "'Solver/Method' = cg-ic0, not with <" +
                           solver() + ">."));
    extended_mass.hold(this->held);
  }



  template <int dim>
  void
  ConsistentMass<dim>::solve(const std::vector<VectorField<dim> *>       &x,
                             const std::vector<const VectorField<dim> *> &b,
                             const std::vector<double> &shares)
  {
    AssertDimension(x.size(), b.size());
    check(solver_of_all ? solver_of_all->solve(x, b, shares)
                        : solve_components(x, b));
  }



  template <int dim>
  void
  ConsistentMass<dim>::check(const SolveResult &result)
  {
    // What does not iterate is not meant to reach a tolerance.
    AssertThrow(!result.iterations || result.converged,
                ExcMessage("The solver <" + parameters.solver.method +
                           "> of the mass matrix failed: it " + result.reason +
                           ". The matrix is singular where a body has fewer "
                           "points across it than functions of 'Grid/Order' "
                           "see it: look at 'Points per direction'."));
    this->iterations = result.iterations.value_or(0);
  }



  template <int dim>
  void
  ConsistentMass<dim>::solve_held(VectorField<dim>                 &x,
                                  const VectorField<dim>           &b,
                                  const std::vector<unsigned char> &more)
  {
    Assert(solver_of_held, ExcMessage("There are no friction walls."));
    std::vector<unsigned char> all_held = this->for_local_functions(more);
    for (unsigned int f = 0; f < all_held.size(); ++f)
      all_held[f] |= this->held[f];

    extended_mass.hold(all_held);
    solver_of_held->update(held_solver_is_behind, total_mass);
    held_solver_is_behind    = false;
    const SolveResult result = solver_of_held->solve({&x}, {&b});
    extended_mass.hold(this->held);
    check(result);
  }



  template <int dim>
  SolveResult
  ConsistentMass<dim>::solve_components(
    const std::vector<VectorField<dim> *>       &x,
    const std::vector<const VectorField<dim> *> &b)
  {
    // The solvers of the groups start from zero, and have the unknowns where
    // the space has them.
    constexpr unsigned int width = 4;
    VectorType             unknowns, rows, full, full_rows;
    extended_mass.initialize_vector(unknowns, width);
    extended_mass.initialize_vector(rows, width);
    this->space().initialize_vector(full);
    this->space().initialize_vector(full_rows);
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
  ConsistentMass<dim>::fragment_fraction() const
  {
    std::uint64_t n = 0;
    for (const double part : filled_part)
      n += part > 0.;
    n = Utilities::MPI::sum(n, this->space().communicator());
    return n > 0 ? double(n_fragments()) / n : 0.;
  }



  template class ConsistentMass<2>;
  template class ConsistentMass<3>;
} // namespace greville

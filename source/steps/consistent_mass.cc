// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/names.h>
#include <greville/steps/consistent_mass.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  ConsistentMass<dim>::ConsistentMass(const OrderHierarchy<dim>  &orders,
                                      const SimulationParameters &parameters,
                                      const Walls<dim>           &walls)
    : GridMass<dim>(orders, walls)
    , parameters(parameters)
    , solver_parameters(parameters.solver)
    , walls(walls)
  {
    filling.reinit(this->space(),
                   {},
                   parameters.scheme.averages_over_domains());
    mass_solver = std::make_unique<ExtendedMassSolver<dim>>(
      extended_mass,
      solver_parameters,
      make_preconditioner(),
      parameters.solver.tight_tolerance());
  }



  template <int dim>
  ColumnPreconditioner
  ConsistentMass<dim>::make_preconditioner()
  {
    if (parameters.solver.has_factorization())
      return {};
    if (parameters.solver.has_cycle())
      {
        if (!multigrid)
          multigrid = std::make_unique<ExtendedMultigrid<dim>>(
            this->orders,
            extended_mass,
            [this](const SplineSpace<dim> &space, const unsigned int c) {
              return constrained_at_walls(space, walls, c);
            },
            parameters.multigrid,
            parameters.smoother);
        return [this](VectorType        &z,
                      const VectorType  &r,
                      const unsigned int width,
                      const unsigned int n_columns) {
          multigrid->vmult(z, r, width, n_columns);
        };
      }
    return [this](VectorType        &z,
                  const VectorType  &r,
                  const unsigned int width,
                  const unsigned int) {
      const bool is_scaled = parameters.solver.has_diagonal();
      for (unsigned int i = 0; i < r.locally_owned_size(); ++i)
        z.local_element(i) =
          r.local_element(i) /
          (is_scaled ? diagonal.local_element(i / width) : 1.);
    };
  }



  template <int dim>
  void
  ConsistentMass<dim>::update(
    const VectorType                               &lumped,
    const std::vector<const MaterialPoints<dim> *> &all_bodies,
    const std::vector<const MaterialPoints<dim> *> &surfaces,
    const PointTransfer<dim>                       &point_transfer)
  {
    this->lumped_mass.copy_locally_owned_data_from(lumped);
    bodies   = &all_bodies;
    transfer = &point_transfer;
    for (const MaterialPoints<dim> *points : surfaces)
      for (const unsigned int cell : points->cells())
        if (filled_part[cell] == 0.)
          filled_part[cell] = -1.;
    // Mass and tangent of implicit steps have the same unknowns.
    const bool unknowns_changed =
      filling.update(filled_part,
                     parameters.scheme.filling_threshold(
                       is_implicit_scheme(parameters.scheme.stress_update)));
    if (unknowns_changed)
      {
        spline_extension.reinit(this->space(), filling);
        if (windows)
          windows->update(spline_extension);
      }
    has_new_unknowns = has_new_unknowns || unknowns_changed;
    is_assembled     = false;
    if (!is_implicit_scheme(parameters.scheme.stress_update))
      assemble();
  }



  template <int dim>
  void
  ConsistentMass<dim>::assemble()
  {
    if (!has_matrix)
      extended_mass.reinit(this->space());
    has_matrix = true;
    extended_mass.begin(spline_extension, has_new_unknowns);
    if (has_new_unknowns)
      extended_mass.unknowns().constrain(this->constrained);
    transfer->add_mass_matrix(*bodies, extended_mass.matrix());
    extended_mass.finish();
    total_mass = 0.;
    for (unsigned int i = 0; i < this->lumped_mass.locally_owned_size(); ++i)
      total_mass += this->lumped_mass.local_element(i);
    total_mass = Utilities::MPI::sum(total_mass, this->space().communicator());
    if (parameters.solver.has_diagonal())
      extended_mass.approximate_diagonal(diagonal);
    if (multigrid)
      multigrid->update(filling,
                        has_new_unknowns,
                        [&](DensityWeights<dim> &weights) {
                          transfer->mass_weights(*bodies, weights);
                        });
    mass_solver->update(total_mass, &this->lumped_mass);
    has_new_unknowns = false;
    is_assembled     = true;
  }



  template <int dim>
  void
  ConsistentMass<dim>::solve(const std::vector<VectorField<dim> *>       &x,
                             const std::vector<const VectorField<dim> *> &b,
                             const std::vector<double> &shares)
  {
    AssertThrow(x.size() == b.size(), ExcDimensionMismatch(x.size(), b.size()));
    if (!is_assembled)
      assemble();
    solver_parameters.tolerance =
      parameters.mass_tolerance(this->space().degree());
    const SolveResult result = mass_solver->solve(x, b, shares);
    AssertThrow(result.converged,
                ErrorOnAll(
                  "The solver <" + solver() +
                  "> of the mass matrix failed: it " + result.reason +
                  ". The matrix is singular if a body has fewer "
                  "points across its thickness than B-splines of "
                  "'Grid/Order' there: check 'Points per direction'."));
    this->iterations = *result.iterations;
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



  GREVILLE_INSTANTIATE_CLASS(ConsistentMass);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

// The preconditioner and the linear solver of TangentSystem.

#include <greville/linear_algebra/krylov.h>
#include <greville/stiffness/tangent_system.h>

#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  TangentSystem<dim>::choose_smoother(PMultigridParameters &cycle,
                                      SmootherParameters   &smoother) const
  {
    if (cycle.smoother != "auto")
      return;
    // Ratios of the moduli for Poisson's ratios of 0.4 and 0.475.
    constexpr double stiff_ratio = 6., very_stiff_ratio = 20.;
    const auto      &moduli = of_bodies.moduli();
    const double     ratio  = moduli[1] > 0.
                                ? moduli[0] / moduli[1]
                                : std::numeric_limits<double>::infinity();
    // Plastic flow makes points soft in some directions, unless inertia adds to
    // them.
    const bool flows      = of_bodies.has_plastic_flow() && mass_factor == 0.;
    const bool separately = by_components || flows || ratio > stiff_ratio;
    cycle.smoother = separately ? "chebyshev-component-ic0" : "chebyshev-ic0";
    if (ratio > stiff_ratio)
      {
        smoother.chebyshev_degree += ratio > very_stiff_ratio ? 3 : 1;
        smoother.chebyshev_range *= ratio > very_stiff_ratio ? 4. : 2.;
      }
    if (separately)
      {
        // Pivots fail if one direction is much stiffer than the others.
        constexpr double smallest_shift = 1e-3;
        smoother.shift = std::max(smoother.shift, smallest_shift);
      }
  }



  namespace
  {
    /// A preconditioner of a level, for vectors of unknowns.
    template <int dim>
    class OfUnknowns : public Preconditioner
    {
    public:
      OfUnknowns(std::unique_ptr<const Preconditioner> preconditioner,
                 const TangentLevel<dim>              &level)
        : preconditioner(std::move(preconditioner))
        , unknowns(level.extended().unknowns())
      {
        for (VectorType *vector : {&to, &from})
          initialize_vector<dim>(*vector, level);
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        unknowns.write(from, src, dim);
        preconditioner->vmult(to, from);
        unknowns.read(dst, to, dim);
      }

    private:
      const std::unique_ptr<const Preconditioner> preconditioner;
      const ExtendedUnknowns<dim>                &unknowns;
      mutable VectorType                          to, from;
    };
  } // namespace



  template <int dim>
  void
  TangentSystem<dim>::make_multigrid()
  {
    multigrid.reset();
    if (parameters.multigrid.coarsens_lattices())
      {
        LatticePart                       part = lattice_part();
        typename LatticeCycle<dim>::Parts parts;
        parts.push_back(std::move(part.finest));
        multigrid = std::make_unique<LatticeCycle<dim>>(
          std::move(parts), part.parameters, nullptr, part.coarsens, true);
        return;
      }
    PMultigridParameters             cycle    = parameters.multigrid;
    SmootherParameters               smoother = parameters.smoother;
    typename PMultigrid<dim>::Levels operators;
    choose_smoother(cycle, smoother);
    if (!has_levels)
      cycle.coarsening = Coarsening::none;
    else
      for (unsigned int l = 0; l + 1 < levels.size(); ++l)
        operators.push_back(levels[l].get());
    operators.push_back(levels.back().get());
    multigrid = std::make_unique<OfUnknowns<dim>>(
      std::make_unique<PMultigrid<dim>>(
        operators, cycle, smoother, parameters.multigrid.coarse_tolerance),
      finest());
  }



  template <int dim>
  typename TangentSystem<dim>::LatticePart
  TangentSystem<dim>::lattice_part() const
  {
    PMultigridParameters cycle    = parameters.multigrid;
    SmootherParameters   smoother = parameters.smoother;
    choose_smoother(cycle, smoother);
    return {finest().make_lattice(), cycle.of_lattices(smoother), has_levels};
  }



  template <int dim>
  bool
  TangentSystem<dim>::takes_cg() const
  {
    return parameters.takes_cg(symmetric) && !of_bodies.has_projection();
  }



  template <int dim>
  unsigned int
  TangentSystem<dim>::n_basis_vectors() const
  {
    if (takes_cg())
      return 0;
    // With a projection, restarts cost more than the basis vectors they save.
    return of_bodies.has_projection() ? parameters.max_iterations : 100;
  }



  template <int dim>
  void
  TangentSystem<dim>::multiply(VectorType &dst, const VectorType &src)
  {
    finest().multiply_of_unknowns(dst, src);
    if (!of_bodies.has_rest())
      return;
    VectorField<dim> direction, force;
    for (VectorField<dim> *field : {&direction, &force})
      for (VectorType &component : *field)
        space().initialize_vector(component);
    extend(direction, src);
    of_bodies.multiply_rest(force, direction);
    VectorType rows;
    initialize(rows);
    restrict(rows, force, nullptr);
    dst += rows;
  }



  template <int dim>
  SolveResult
  TangentSystem<dim>::solve(VectorType       &x,
                            const VectorType &b,
                            const double      tolerance)
  {
    return solve_together({this}, tolerance, [&](const unsigned int n) {
      return solve_krylov(
        {tolerance, n},
        [&](VectorType &dst, const VectorType &src) { multiply(dst, src); },
        [&](VectorType &dst, const VectorType &src) { precondition(dst, src); },
        x,
        b,
        n_basis_vectors());
    });
  }



  template <int dim>
  SolveResult
  TangentSystem<dim>::solve_together(
    const std::vector<TangentSystem *>                              &systems,
    const double                                                     tolerance,
    const std::function<SolveResult(const unsigned int iterations)> &run)
  {
    const TangentParameters     &parameters = systems.front()->parameters;
    std::vector<TangentSystem *> used;
    double                       first = 0.;
    for (TangentSystem *system : systems)
      if (!system->reuse.is_fresh())
        {
          used.push_back(system);
          first = std::max(first, system->reuse.iterations_per_digit());
        }

    unsigned int n_wasted = 0;
    SolveResult  result;
    if (!used.empty())
      {
        const double expected = -std::log10(tolerance) * first;
        result =
          run(std::min<double>(parameters.max_iterations,
                               std::ceil(expected + parameters.reuse + 1.)));
        if (!result.converged)
          {
            n_wasted = *result.iterations;
            for (TangentSystem *system : used)
              system->set_up();
            used.clear();
          }
        else
          for (TangentSystem *system : used)
            system->reuse.count(result);
      }
    if (used.empty())
      result = run(parameters.max_iterations);
    for (TangentSystem *system : systems)
      if (system->reuse.is_fresh())
        system->reuse.begin_count(result);
    *result.iterations += n_wasted;
    return result;
  }



  template <int dim>
  SolveResult
  TangentSystem<dim>::solve_mass(VectorField<dim>       &velocity,
                                 const VectorField<dim> &momentum)
  {
    static const SolverParameters accurate{1e-12, 200};
    if (!mass_solver)
      mass_solver =
        std::make_unique<ExtendedMassSolver<dim>>(levels.back()->extended(),
                                                  accurate);
    if (mass_is_new)
      mass_solver->update(total_mass);
    mass_is_new = false;
    // Begin with zero: a guess would not be the same after a restart.
    const auto &constrained = finest().constrained_components();
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int i = 0; i < velocity[c].locally_owned_size(); ++i)
        if (!((constrained[i] >> c) & 1))
          velocity[c].local_element(i) = 0.;
    SolveResult result = mass_solver->solve({&velocity}, {&momentum});
    // If few points are spread widely, round-off may exceed the tolerance.
    constexpr double negligible = 1e-9;
    result.converged = result.converged || result.reduction < negligible;
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(TangentSystem);
} // namespace greville

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
    const double     ratio = moduli[1] > 0.
                               ? moduli[0] / moduli[1]
                               : std::numeric_limits<double>::infinity();
    cycle.smoother         = ratio <= stiff_ratio && !by_components
                               ? "chebyshev-ic0"
                               : "chebyshev-component-ic0";
    if (ratio > stiff_ratio)
      {
        smoother.chebyshev_degree += ratio > very_stiff_ratio ? 3 : 1;
        smoother.chebyshev_range *= ratio > very_stiff_ratio ? 4. : 2.;
      }
    if (ratio > stiff_ratio || by_components)
      {
        // Pivots fail if one direction is much stiffer than the others.
        constexpr double smallest_shift = 1e-3;
        smoother.shift = std::max(smoother.shift, smallest_shift);
      }
  }



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
        multigrid = std::make_unique<LatticeCycle<dim>>(std::move(parts),
                                                        part.parameters,
                                                        nullptr,
                                                        part.coarsens);
        return;
      }
    PMultigridParameters             cycle    = parameters.multigrid;
    SmootherParameters               smoother = parameters.smoother;
    typename PMultigrid<dim>::Levels operators;
    choose_smoother(cycle, smoother);
    if (!has_levels)
      cycle.coarsening = "none";
    else
      for (unsigned int l = 0; l + 1 < levels.size(); ++l)
        operators.push_back(levels[l].get());
    operators.push_back(levels.back().get());
    multigrid = std::make_unique<PMultigrid<dim>>(
      operators, cycle, smoother, parameters.multigrid.coarse_tolerance);
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
  void
  TangentSystem<dim>::for_each_weight(const MaterialPoints<dim> &points,
                                      const VisitWeight         &visit) const
  {
    const ExtendedMass<dim> &mass        = finest().extended();
    const auto              &constrained = finest().constrained_components();
    of_surfaces.for_each_value(
      points,
      [&](const std::size_t s, const unsigned int f, const double value) {
        mass.unknowns().for_each_unknown(
          mass.matrix().place(f),
          [&](const unsigned int u, const double weight) {
            visit(s, u, value * weight, constrained[f]);
          });
      });
  }



  template <int dim>
  void
  TangentSystem<dim>::multiply(VectorType &dst, const VectorType &src)
  {
    finest().vmult(dst, src);
    if (!projection && !windows)
      return;
    VectorField<dim> direction, force;
    for (VectorField<dim> *field : {&direction, &force})
      for (VectorType &component : *field)
        space().initialize_vector(component);
    extend(direction, src);
    sums.clear();
    if (windows)
      {
        windows->read(direction, window_buffer);
        for (const auto &of_cell : domains)
          sums.add_change(of_cell.first,
                          of_cell.second,
                          tangents,
                          window_buffer);
      }
    std::vector<TrialGroup<dim>> groups;
    for (const ProjectedBody<dim> &body : projected_bodies)
      {
        const MaterialPoints<dim> &points = *body.points;
        const double              *change = projection
                                 ->differentiate(points,
                                                 displacement,
                                                 direction,
                                                 body.J_hat,
                                                 body.share)
                                 .data();
        const auto *derivative = body.derivatives.data();
        for (const unsigned int cell : points.cells())
          {
            groups.clear();
            unsigned int count = points.n_in_first_group(cell);
            for (unsigned int g = points.first_group(cell); g != points.none;
                 g = points.next_group(g), count = n_lanes, ++derivative)
              {
                TrialGroup<dim> &group  = groups.emplace_back();
                Lanes            factor = 0.;
                for (unsigned int lane = 0; lane < count; ++lane)
                  factor[lane] = *change++;
                const double *x =
                  points.group(g) + points.layout().basis_position * n_lanes;
                for (unsigned int d = 0; d < dim; ++d)
                  group.x[d] = load<Lanes>(x + d * n_lanes);
                for (unsigned int r = 0; r < group.stress.size(); ++r)
                  group.stress[r] = factor * (*derivative)[r];
              }
            sums.add_force(cell, groups);
          }
      }
    sums.take_force(force);
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
    const TangentParameters &parameters = systems.front()->parameters;
    // Return the number of digits by which the residual decreases.
    const auto digits = [](const SolveResult &result) {
      return std::max(0.5, -std::log10(std::max(result.reduction, 1e-16)));
    };
    std::vector<TangentSystem *> used;
    double                       first = 0.;
    for (TangentSystem *system : systems)
      if (!system->is_fresh)
        {
          used.push_back(system);
          first = std::max(first, system->first_iterations);
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
            {
              const double excess =
                std::max(0.,
                         *result.iterations -
                           digits(result) * system->first_iterations);
              system->excess_iterations += excess;
              // The assembly costs about as much as this number of iterations.
              system->wants_entries = excess > dim - 1.;
            }
      }
    if (used.empty())
      result = run(parameters.max_iterations);
    for (TangentSystem *system : systems)
      if (system->is_fresh)
        {
          system->first_iterations = *result.iterations / digits(result);
          system->is_fresh         = *result.iterations == 0;
        }
    *result.iterations += n_wasted;
    return result;
  }



  template <int dim>
  SolveResult
  TangentSystem<dim>::solve_mass(VectorField<dim>       &velocity,
                                 const VectorField<dim> &momentum)
  {
    VectorType x, b;
    initialize(x);
    initialize(b);
    // Move the contribution of constrained coefficients to the right-hand side.
    VectorField<dim> constrained;
    for (unsigned int c = 0; c < dim; ++c)
      constrained[c] = velocity[c];
    extend(constrained, x);
    for (unsigned int c = 0; c < dim; ++c)
      constrained[c] *= -1.;
    restrict(b, momentum, &constrained);
    SolveResult result = solve_krylov(
      {1e-12, 200},
      [&](VectorType &dst, const VectorType &src) {
        finest().multiply_mass(dst, src);
      },
      [&](VectorType &dst, const VectorType &src) {
        dst = src;
        finest().apply_inverse_mass(dst);
      },
      x,
      b);
    // If few points are spread widely, round-off may exceed the tolerance.
    constexpr double negligible = 1e-9;
    result.converged = result.converged || result.reduction < negligible;
    extend(velocity, x);
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(TangentSystem);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

// The linear solver of TangentSystem.

#include <greville/linear_algebra/krylov.h>
#include <greville/stiffness/tangent_system.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

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
    // Return the digits by which the residual decreases.
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
    // The contribution of constrained coefficients moves to the right-hand
    // side.
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
    // Round-off may leave more than the tolerance if points spread thinly.
    constexpr double negligible = 1e-9;
    result.converged = result.converged || result.reduction < negligible;
    extend(velocity, x);
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(TangentSystem);
} // namespace greville

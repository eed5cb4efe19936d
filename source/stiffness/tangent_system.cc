// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>

#include <greville/stiffness/tangent_system.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace greville
{
  using namespace dealii;

  TangentParameters::TangentParameters()
  {
    multigrid.coarsening            = "direct";
    multigrid.prolongation          = "ic0-l2";
    multigrid.restriction           = "transpose";
    multigrid.smoother              = "auto";
    multigrid.coarse_tolerance      = 1.;
    multigrid.coarse_preconditioner = "gamg";
    smoother.chebyshev_degree       = 3;
    smoother.chebyshev_range        = 8.;
  }



  void
  TangentParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Method",
                      method,
                      "The Krylov method, preconditioned by p-multigrid: cg is "
                      "for symmetric tangents, fgmres for all; auto takes cg "
                      "where all materials have symmetric ones.",
                      Patterns::Selection("auto|cg|fgmres"));
    prm.add_parameter(
      "Preconditioner",
      preconditioner,
      "p-multigrid: the cycle of 'Implicit p-multigrid'; smoother: its "
      "smoother "
      "alone; auto: the smoother alone where mass outweighs stiffness (up to a "
      "Courant number of about 3) and in strips one cell wide, else "
      "p-multigrid.",
      Patterns::Selection("auto|p-multigrid|smoother"));
    prm.add_parameter("Maximum iterations",
                      max_iterations,
                      "A step whose linear systems need more is cut. Unit: "
                      "iterations.",
                      Patterns::Integer(1));
    prm.add_parameter(
      "Reuse",
      reuse,
      "The set-up of a preconditioner serves following systems, too, until the "
      "iterations that they need beyond those of the first one add up to this "
      "number. 0: each system has its own. Unit: iterations.",
      Patterns::Integer(0));
  }



  template <int dim>
  TangentSystem<dim>::TangentSystem(
    const unsigned int             degree,
    DistributedTriangulation<dim> &triangulation,
    const HeldFunctions           &held,
    const TangentParameters       &parameters,
    const double                   filling_threshold,
    const bool                     lump,
    VolumeProjection<dim>         *projection)
    : parameters(parameters)
    , filling_threshold(filling_threshold)
    , lump(lump)
    , orders(triangulation, degree, parameters.multigrid.coarsening)
    , transfers(orders.n_levels())
    , sums(orders.n_levels())
    , projection(projection)
  {
    filling.reinit(orders.finest());
    trial.reinit(orders.finest());
    trial_surfaces.reinit(orders.finest());
    surface_sums.reinit(orders.finest());
    for (unsigned int l = 0; l < orders.n_levels(); ++l)
      {
        transfers[l].reinit(orders[l]);
        sums[l].reinit(orders[l]);
        levels.push_back(
          std::make_unique<TangentLevel<dim>>(orders[l], held(orders[l])));
      }
  }



  template <int dim>
  void
  TangentSystem<dim>::set_points(const std::vector<TrialBody<dim>> &bodies)
  {
    std::vector<const MaterialPoints<dim> *> points;
    for (const TrialBody<dim> &body : bodies)
      points.push_back(body.points);
    transfers.back().filling(points, filled_part);
    const bool changed =
      filling.update(filled_part, filling_threshold) || is_first;
    is_first = false;
    if (changed)
      forget();
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        levels[l]->begin(filling, changed);
        transfers[l].add_mass_matrix(points, levels[l]->mass());
        levels[l]->finish_mass(lump);
        transfers[l].mass_weights(points, levels[l]->weights());
      }
    finest().extended().initialize_vector(unknowns, dim);
  }



  namespace
  {
    /**
     * Add the moduli of compression and of shear, A_iiii and A_ijij, times the
     * volumes.
     */
    template <int dim>
    void
    add_moduli(const std::vector<TrialPoint<dim>> &points,
               std::array<double, 2>              &moduli)
    {
      constexpr double n_shears = dim * (dim - 1);
      for (const TrialPoint<dim> &point : points)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            moduli[i == j ? 0 : 1] +=
              point.volume * point.A[i][j][i][j] / (i == j ? dim : n_shears);
    }
  } // namespace



  template <int dim>
  std::string
  TangentSystem<dim>::evaluate(const std::vector<TrialBody<dim>> &bodies,
                               const VectorField<dim>            &u,
                               const double                       dt,
                               const StepStress                   stress,
                               const bool        with_stiffness,
                               VectorField<dim> &force)
  {
    std::string problem;
    sums.back().clear();
    if (with_stiffness)
      {
        moduli = {};
        for (auto &level : levels)
          level->begin_tangent();
      }
    for (const TrialBody<dim> &body : bodies)
      {
        const bool is_symmetric = body.material->has_symmetric_tangent() &&
                                  stress == StepStress::end && !projection;
        const PointReport report =
          trial.evaluate(*body.points,
                         *body.material,
                         u,
                         dt,
                         body.strength_reduction,
                         stress,
                         with_stiffness,
                         projection,
                         [&](const unsigned int cell, const auto &points) {
                           sums.back().add_force(cell, points);
                           if (with_stiffness)
                             add_moduli<dim>(points, moduli);
                           if (with_stiffness)
                             for (unsigned int l = 0; l < levels.size(); ++l)
                               levels[l]->stiffness().add_cell(
                                 cell,
                                 sums[l].stiffness(cell, points, is_symmetric));
                         });
        if (report.bad_point >= 0 && problem.empty())
          problem = "point " + std::to_string(report.bad_point) +
                    " of the body '" + body.name + "': " + report.bad_reason;
      }
    sums.back().take_force(force);
    if (with_stiffness)
      Utilities::MPI::sum(ArrayView<const double>(moduli.data(), 2),
                          space().communicator(),
                          ArrayView<double>(moduli.data(), 2));
    if (with_stiffness && projection)
      last = {bodies, u, force, dt, stress, {}, {}, {}};
    return problem;
  }



  template <int dim>
  bool
  TangentSystem<dim>::add_surfaces(
    const std::vector<LoadedSurface<dim>> &surfaces,
    const VectorField<dim>                &u,
    const SurfaceMotion<dim>              &motion,
    const bool                             with_stiffness,
    VectorField<dim>                      &force)
  {
    // Derivatives are differences.
    constexpr double round_off = 1e-6;

    unsigned int is_asymmetric = 0;
    surface_sums.clear();
    for (const LoadedSurface<dim> &surface : surfaces)
      trial_surfaces.evaluate(
        surface,
        u,
        motion,
        with_stiffness,
        [&](const unsigned int cell, const auto &points) {
          surface_sums.add_force(cell, points);
          if (!with_stiffness)
            return;
          for (unsigned int l = 0; l < levels.size(); ++l)
            levels[l]->stiffness().add_cell(cell,
                                            sums[l].stiffness(cell, points));
          for (const TrialSurfacePoint<dim> &point : points)
            {
              const Tensor<2, dim> &D = point.by_displacement;
              if (point.by_gradient.norm() > 0. ||
                  (D - transpose(D)).norm() > round_off * D.norm())
                is_asymmetric = 1;
            }
        });
    surface_sums.take_force(force);
    if (!with_stiffness)
      return true;
    if (projection)
      {
        last.surfaces      = surfaces;
        last.motion        = motion;
        last.surface_force = force;
      }
    return Utilities::MPI::max(is_asymmetric, space().communicator()) == 0;
  }



  template <int dim>
  void
  TangentSystem<dim>::multiply_by_differences(VectorType       &dst,
                                              const VectorType &src)
  {
    // Of strains, between round-off and what is not linear.
    constexpr double difference = 1e-7;
    if (direction[0].size() == 0)
      for (VectorField<dim> *field : {&direction, &moved, &moved_force})
        for (VectorType &component : *field)
          space().initialize_vector(component);
    double largest = 0.;
    for (VectorType &component : direction)
      component = 0.;
    extend(direction, src);
    for (const VectorType &component : direction)
      largest = std::max(largest, component.linfty_norm());
    dst = 0.;
    if (!(largest > 0.))
      return;
    double h = space().lattice().cell_size(0);
    for (unsigned int d = 1; d < dim; ++d)
      h = std::min(h, space().lattice().cell_size(d));
    const double eps = difference * h / largest;
    for (unsigned int d = 0; d < dim; ++d)
      {
        moved[d] = last.u[d];
        moved[d].add(eps, direction[d]);
        direction[d] *= mass_factor;
      }
    evaluate(last.bodies, moved, last.dt, last.stress, false, moved_force);
    for (unsigned int d = 0; d < dim; ++d)
      {
        moved_force[d] -= last.force[d];
        moved_force[d] *= 1. / eps;
      }
    if (!last.surfaces.empty())
      {
        VectorField<dim> change = last.surface_force;
        add_surfaces(last.surfaces, moved, last.motion, false, change);
        for (unsigned int d = 0; d < dim; ++d)
          moved_force[d].add(-1. / eps,
                             change[d],
                             1. / eps,
                             last.surface_force[d]);
      }
    restrict(dst, moved_force, mass_factor != 0. ? &direction : nullptr);
  }



  template <int dim>
  bool
  TangentSystem<dim>::needs_levels(const double mass_factor) const
  {
    if (parameters.preconditioner != "auto")
      return parameters.preconditioner == "p-multigrid";
    if (parameters.multigrid.coarsening == "none")
      return false;
    unsigned int n_long = 0;
    for (unsigned int d = 0; d < dim; ++d)
      n_long += space().lattice().n_cells()[d] > 1;
    if (n_long <= 1)
      return false;
    if (mass_factor == 0.)
      return true;
    // The largest entries of K and c M, those of the last finish_tangent().
    constexpr double stiff   = 30.;
    double           sums[2] = {finest().largest_diagonal(), 0.};
    double           mass    = 0.;
    for (const unsigned int place : finest().extended().unknown_places())
      if (place != numbers::invalid_unsigned_int)
        mass = std::max(mass, finest().extended().matrix().diagonal(place));
    sums[1] = mass_factor * mass;
    Utilities::MPI::max(ArrayView<const double>(sums, 2),
                        space().communicator(),
                        ArrayView<double>(sums, 2));
    return sums[0] > (1. + stiff) * sums[1];
  }



  template <int dim>
  bool
  TangentSystem<dim>::is_reusable(const double mass_factor,
                                  const bool   with_levels) const
  {
    constexpr double much = 2.;
    return multigrid && parameters.reuse > 0 && has_levels == with_levels &&
           excess_iterations <= parameters.reuse &&
           mass_factor <= much * mass_factor_of_set_up &&
           mass_factor_of_set_up <= much * mass_factor;
  }



  template <int dim>
  void
  TangentSystem<dim>::choose_smoother(PMultigridParameters &cycle,
                                      SmootherParameters   &smoother) const
  {
    if (cycle.smoother != "auto")
      return;
    // Poisson's ratios of 0.4 and 0.475.
    constexpr double much = 6., most = 20.;
    const double     ratio = moduli[1] > 0.
                               ? moduli[0] / moduli[1]
                               : std::numeric_limits<double>::infinity();
    cycle.smoother =
      ratio <= much ? "chebyshev-ic0" : "chebyshev-component-ic0";
    if (ratio > much)
      {
        smoother.chebyshev_degree += ratio > most ? 3 : 1;
        smoother.chebyshev_range *= ratio > most ? 4. : 2.;
        // Pivots fail where one direction is much stiffer than the others.
        constexpr double smallest_shift = 1e-3;
        smoother.shift = std::max(smoother.shift, smallest_shift);
      }
  }



  template <int dim>
  void
  TangentSystem<dim>::set_up(const bool with_levels)
  {
    PMultigridParameters             cycle    = parameters.multigrid;
    SmootherParameters               smoother = parameters.smoother;
    typename PMultigrid<dim>::Levels operators;
    choose_smoother(cycle, smoother);
    if (!with_levels)
      cycle.coarsening = "none";
    else
      for (unsigned int l = 0; l + 1 < levels.size(); ++l)
        operators.push_back(levels[l].get());
    operators.push_back(levels.back().get());
    multigrid.reset();
    multigrid = std::make_unique<PMultigrid<dim>>(
      operators, cycle, smoother, parameters.multigrid.coarse_tolerance);
    has_levels            = with_levels;
    mass_factor_of_set_up = mass_factor;
    excess_iterations     = 0.;
    is_fresh              = true;
    ++set_ups;
  }



  template <int dim>
  void
  TangentSystem<dim>::set_operator(const double new_mass_factor,
                                   const bool   is_symmetric)
  {
    symmetric   = is_symmetric;
    mass_factor = new_mass_factor;
    levels.back()->finish_tangent(mass_factor);
    const bool with_levels = needs_levels(mass_factor);
    if (with_levels)
      for (unsigned int l = 0; l + 1 < levels.size(); ++l)
        levels[l]->finish_tangent(mass_factor);
    if (!is_reusable(mass_factor, with_levels))
      set_up(with_levels);
  }



  template <int dim>
  void TangentSystem<dim>::restrict(VectorType             &rows,
                                    const VectorField<dim> &force,
                                    const VectorField<dim> *field) const
  {
    const ExtendedMass<dim> &mass = finest().extended();
    mass.restrict_fields(unknowns, {&force}, dim);
    if (field)
      {
        VectorField<dim> products;
        for (unsigned int c = 0; c < dim; ++c)
          products[c].reinit(force[c], true);
        mass.multiply_field(products, *field, true);
        const auto &functions = mass.unknown_functions();
        for (unsigned int u = 0; u < functions.size(); ++u)
          for (unsigned int c = 0; c < dim; ++c)
            unknowns.local_element(u * dim + c) +=
              products[c].local_element(functions[u]);
        mass.zero_held_unknowns(unknowns, dim);
      }
    finest().write(rows, unknowns);
  }



  template <int dim>
  void
  TangentSystem<dim>::extend(VectorField<dim> &field, const VectorType &x) const
  {
    finest().read(unknowns, x);
    finest().extended().write_fields({&field}, unknowns, dim);
  }



  template <int dim>
  void
  TangentSystem<dim>::read(VectorType &x, const VectorField<dim> &field) const
  {
    finest().extended().read_fields(unknowns, {&field}, dim);
    finest().write(x, unknowns);
  }



  namespace
  {
    /**
     * Run a Krylov method, which stops by an exception where it does not
     * converge.
     */
    template <typename Run>
    SolveResult
    run_solver(const unsigned int max_iterations,
               const double       tolerance,
               const VectorType  &b,
               const Run         &run)
    {
      SolveResult  result;
      const double start = b.l2_norm();
      result.iterations  = 0;
      result.converged   = start == 0.;
      if (start == 0.)
        return result;
      SolverControl control(max_iterations, tolerance * start, false, false);
      try
        {
          run(control);
          result.converged = true;
        }
      catch (const SolverControl::NoConvergence &)
        {}
      result.iterations = control.last_step();
      result.reduction  = control.last_value() / start;
      if (!result.converged)
        {
          std::ostringstream text;
          text << "did not converge in " << control.last_step()
               << " iterations; the residual is " << result.reduction
               << " times the right-hand side";
          result.reason = text.str();
        }
      return result;
    }
  } // namespace



  template <int dim>
  SolveResult
  TangentSystem<dim>::solve(VectorType       &x,
                            const VectorType &b,
                            const double      tolerance)
  {
    struct ByDifferences
    {
      void
      vmult(VectorType &dst, const VectorType &src) const
      {
        system.multiply_by_differences(dst, src);
      }

      TangentSystem &system;
    };
    const bool with_cg =
      parameters.method == "cg" || (parameters.method == "auto" && symmetric);
    const auto run = [&](const unsigned int max_iterations) {
      x = 0.;
      return run_solver(
        max_iterations, tolerance, b, [&](SolverControl &control) {
          using Fgmres = SolverFGMRES<VectorType>;
          // A product by differences costs more than the vectors of a restart.
          constexpr unsigned int n_vectors = 100;
          if (projection)
            Fgmres(control, Fgmres::AdditionalData(n_vectors))
              .solve(ByDifferences{*this}, x, b, *multigrid);
          else if (with_cg)
            SolverCG<VectorType>(control).solve(finest(), x, b, *multigrid);
          else
            Fgmres(control).solve(finest(), x, b, *multigrid);
        });
    };
    // Digits that the residual loses.
    const auto digits = [](const SolveResult &result) {
      return std::max(0.5, -std::log10(std::max(result.reduction, 1e-16)));
    };

    unsigned int n_wasted = 0;
    SolveResult  result;
    if (!is_fresh)
      {
        const double expected = -std::log10(tolerance) * first_iterations;
        result =
          run(std::min<double>(parameters.max_iterations,
                               std::ceil(expected + parameters.reuse + 1.)));
        if (!result.converged)
          {
            n_wasted = *result.iterations;
            set_up(has_levels);
          }
        else
          excess_iterations +=
            std::max(0.,
                     *result.iterations - digits(result) * first_iterations);
      }
    if (is_fresh)
      {
        result           = run(parameters.max_iterations);
        first_iterations = *result.iterations / digits(result);
        is_fresh         = *result.iterations == 0;
      }
    *result.iterations += n_wasted;
    return result;
  }



  template <int dim>
  SolveResult
  TangentSystem<dim>::solve_mass(VectorField<dim>       &velocity,
                                 const VectorField<dim> &momentum)
  {
    struct Mass
    {
      void
      vmult(VectorType &dst, const VectorType &src) const
      {
        level.multiply_mass(dst, src);
      }

      const TangentLevel<dim> &level;
    };
    struct Inverse
    {
      void
      vmult(VectorType &dst, const VectorType &src) const
      {
        dst = src;
        level.apply_inverse_mass(dst);
      }

      const TangentLevel<dim> &level;
    };

    VectorType x, b;
    initialize(x);
    initialize(b);
    // What held coefficients contribute goes to the right-hand side.
    VectorField<dim> held;
    for (unsigned int c = 0; c < dim; ++c)
      held[c] = velocity[c];
    extend(held, x);
    for (unsigned int c = 0; c < dim; ++c)
      held[c] *= -1.;
    restrict(b, momentum, &held);
    SolveResult result = run_solver(200, 1e-12, b, [&](SolverControl &control) {
      SolverCG<VectorType>(control).solve(Mass{finest()},
                                          x,
                                          b,
                                          Inverse{finest()});
    });
    // Round-off may leave more where points spread thinly.
    constexpr double negligible = 1e-9;
    result.converged = result.converged || result.reduction < negligible;
    extend(velocity, x);
    return result;
  }



  template class TangentSystem<2>;
  template class TangentSystem<3>;
} // namespace greville

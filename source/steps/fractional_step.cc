// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/step_errors.h>
#include <greville/linear_algebra/krylov.h>
#include <greville/parameters/pores.h>
#include <greville/steps/fractional_step.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  FractionalStep<dim>::FractionalStep(Discretization<dim> &discretization,
                                      const SimulationParameters &parameters)
    : discretization(discretization)
    , parameters(parameters)
    , water(discretization.space(), discretization.triangulation(), parameters)
  {
    for (auto *field : {&displacement,
                        &without_water,
                        &moved,
                        &force,
                        &sum_of_forces,
                        &change})
      discretization.initialize(*field);
    for (VectorType *vector : {&pressure, &residual, &correction})
      water.initialize(*vector);
  }



  template <int dim>
  void
  FractionalStep<dim>::accelerate(GridField<dim>         &field,
                                  const VectorField<dim> &of_force)
  {
    for (VectorType &component : change)
      component = 0.;
    field.mass->solve({&change}, {&of_force});
  }



  template <int dim>
  void
  FractionalStep<dim>::slide(VectorField<dim> *direction)
  {
    const Walls<dim> &walls = discretization.walls();
    moved                   = displacement;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        if (!walls.is_friction(w))
          continue;
        const unsigned int normal = w / 2;
        const double       sign   = w % 2 == 0 ? -1. : 1.;
        for (const unsigned int i : walls.functions(w))
          {
            if (sign * moved[normal].local_element(i) <= 0.)
              continue;
            Tensor<1, dim> along;
            for (unsigned int c = 0; c < dim; ++c)
              if (c != normal)
                along[c] = moved[c].local_element(i);
            const double friction_limit =
              walls.friction_coefficient(w) *
              std::max(0., sign * without_water[normal].local_element(i));
            const double size  = along.norm();
            const double share = friction_limit < size ? friction_limit / size
                                                       : 1.; // lost fraction
            moved[normal].local_element(i) = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              if (c != normal)
                moved[c].local_element(i) = (1. - share) * along[c];
            if (!direction)
              continue;
            double parallel = 0.;
            for (unsigned int c = 0; c < dim && share < 1.; ++c)
              parallel += along[c] / size * (*direction)[c].local_element(i);
            for (unsigned int c = 0; c < dim; ++c)
              {
                double &value = (*direction)[c].local_element(i);
                if (c == normal)
                  value = 0.;
                else if (share < 1.)
                  value =
                    (1. - share) * value + share * parallel * along[c] / size;
                else
                  value = 0.;
              }
          }
      }
  }



  template <int dim>
  void
  FractionalStep<dim>::take_impulses(const double    step,
                                     const double    velocity_step,
                                     GridField<dim> &field)
  {
    const Walls<dim> &walls  = discretization.walls();
    const VectorType &lumped = field.lumped_mass;
    friction_work            = 0.;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        if (!walls.is_friction(w))
          continue;
        for (const unsigned int i : walls.functions(w))
          for (unsigned int c = 0; c < dim; ++c)
            {
              const double after = moved[c].local_element(i) / step;
              const double change_of_v =
                after - displacement[c].local_element(i) / step;
              if (change_of_v == 0.)
                continue;
              const double impulse = lumped.local_element(i) * change_of_v;
              field.momentum_of_walls[w][c] += impulse;
              field.acceleration[c].local_element(i) +=
                change_of_v / velocity_step;
              friction_work +=
                0.5 * impulse * (field.velocity[c].local_element(i) + after);
              // Count functions in corners once.
              displacement[c].local_element(i) = moved[c].local_element(i);
            }
      }
  }



  template <int dim>
  void
  FractionalStep<dim>::begin(const State<dim>     &state,
                             const Tensor<1, dim> &gravity,
                             const double          step,
                             const double          kick,
                             GridField<dim>       &field)
  {
    if (points_version == 0 || (points_version != state.points_version &&
                                !parameters.scheme.is_total_lagrangian()))
      {
        water.set_points(state.bodies, state.surfaces);
        points_version = state.points_version;
      }
    water.begin_step(
      state.bodies, state.surfaces, state.time + step, step, gravity, 0.);
    for (unsigned int d = 0; d < dim; ++d)
      {
        displacement[d].equ(step, field.velocity[d]);
        displacement[d].add(kick, field.acceleration[d]);
        sum_of_forces[d] = 0.;
      }
    // Water at rest carries a part of the weight near walls.
    const double part_of_water = parameters.water.density / water.density();
    without_water              = displacement;
    for (unsigned int d = 0; d < dim; ++d)
      without_water[d].add(-kick * part_of_water * gravity[d]);
    if (const VectorField<dim> *outer = water.outer_force())
      {
        accelerate(field, *outer);
        for (unsigned int d = 0; d < dim; ++d)
          {
            displacement[d].add(-kick, change[d]);
            sum_of_forces[d] += (*outer)[d];
          }
      }
    pressure = 0.;
  }



  template <int dim>
  unsigned int
  FractionalStep<dim>::add_pressure(const State<dim>     &state,
                                    const Tensor<1, dim> &gravity,
                                    const double          step,
                                    const double          velocity_step,
                                    GridField<dim>       &field)
  {
    constexpr unsigned int most_iterations = 12, n_basis_vectors = 30;
    const double           kick = step * velocity_step;
    begin(state, gravity, step, kick, field);
    const double tolerance = parameters.solver.tight_tolerance();
    unsigned int n_linear  = 0;
    double       first     = 0.;
    for (unsigned int k = 0;; ++k)
      {
        slide();
        water.evaluate(moved, pressure, force, residual);
        const double norm = residual.l2_norm();
        if (k == 0)
          first = norm;
        if (norm <= std::max(tolerance * first, water.round_off()))
          break;
        if (k == most_iterations)
          throw StepFailed(
            "The pore pressure did not converge in " + std::to_string(k) +
              " iterations of Newton's method: the residual is " +
              text_of(norm / first) +
              " of the first one, and 'Solver/Tolerance' is " +
              text_of(tolerance) + ". " +
              describe_water_at_boundaries(parameters) +
              "The pressure changes less in shorter steps: take a smaller "
              "'Time/Step' or 'Time/CFL number'.",
            false);
        water.set_up(1. / kick,
                     [&](const VectorField<dim> &b, VectorField<dim> &u) {
                       accelerate(field, b);
                       slide(&change);
                       u = change;
                     });
        const SolveResult result = solve_krylov(
          {tolerance, parameters.solver.max_iterations},
          [&](VectorType &rows, const VectorType &p) {
            water.spread(p, force);
            accelerate(field, force);
            for (VectorType &component : change)
              component *= -kick;
            slide(&change);
            water.multiply(change, p, force, rows);
          },
          [&](VectorType &p, const VectorType &rows) {
            water.precondition(p, rows);
          },
          correction,
          residual,
          n_basis_vectors);
        n_linear += result.iterations.value_or(0);
        if (!result.converged)
          throw StepFailed("The solver of the pore pressure " + result.reason +
                             ".",
                           false);
        pressure -= correction;
        water.spread(correction, force);
        accelerate(field, force);
        for (unsigned int d = 0; d < dim; ++d)
          {
            displacement[d].add(kick, change[d]);
            sum_of_forces[d] -= force[d];
          }
      }
    accelerate(field, sum_of_forces);
    for (unsigned int d = 0; d < dim; ++d)
      field.acceleration[d] -= change[d];
    discretization.walls().add_constrained(
      field.momentum_of_walls, [&](const unsigned int c, const unsigned int i) {
        return velocity_step * sum_of_forces[c].local_element(i);
      });
    take_impulses(step, velocity_step, field);
    return n_linear;
  }



  template <int dim>
  void
  FractionalStep<dim>::advance(State<dim> &state) const
  {
    state.energy.add_work(EnergyBalance::loads, water.work());
    state.energy.add_friction(friction_work);
    state.water_of_step = water.advance(state.bodies, state.water_of_step);
    for (unsigned int k = 0; k < state.water.size(); ++k)
      state.water[k] += state.water_of_step[k];

    std::vector<MaterialPoints<dim> *>       in_contact;
    std::vector<const MaterialPoints<dim> *> surfaces;
    for (Surface<dim> &surface : state.surfaces)
      if (surface.points.layout().find(PoreWater<dim>::field))
        {
          in_contact.push_back(&surface.points);
          surfaces.push_back(&surface.points);
        }
    if (surfaces.empty())
      return;
    const auto values = water.at_surfaces(pressure, surfaces);
    for (unsigned int k = 0; k < values.size(); ++k)
      {
        auto               value = values[k].begin();
        const unsigned int first =
          surfaces[k]->layout().first(PoreWater<dim>::field);
        in_contact[k]->for_each(
          [&](const PointRef<dim> p) { p[first] = *value++; });
      }
  }



  GREVILLE_INSTANTIATE_CLASS(FractionalStep);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/parameters/in_stage.h>
#include <greville/steps/initial_state.h>
#include <greville/steps/simulation.h>
#include <greville/steps/stage_bodies.h>
#include <greville/steps/step_size.h>

#include <algorithm>

// The stages of a Simulation.
namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Throw if 'Time/Step' is not a valid step or, with @p is_of_whole_stage,
    /// too small for the stage.
    template <int dim>
    void
    check_given_step(const TimeParameters      &time,
                     const Discretization<dim> &discretization,
                     const bool                 is_of_whole_stage)
    {
      if (time.step.empty())
        return;
      const double step =
        evaluate_step(Expression(time.step, "Time/Step", {"h", "p"}),
                      time,
                      discretization.cell_size(),
                      discretization.space().degree());
      if (is_of_whole_stage)
        check_step(step, time.end - time.start, time, [&]() {
          return "'Time/Step' is <" + formula_text(time.step) + ">.";
        });
    }
  } // namespace



  template <int dim>
  void
  Simulation<dim>::enter_stage(const unsigned int stage)
  {
    parameters.enter_stage(stage);
    entered_stage = stage;
    integrator.reset();
    in_stage(parameters, stage, [&]() {
      loads = Loads<dim>(parameters);
      discretization.reinit();
      for (Body<dim> &body : current.bodies)
        body.material =
          parameters.materials.at(body.parameters->material).get();
      for_all_points(current, [&](MaterialPoints<dim> &points) {
        points.set_space(discretization.space());
      });
      integrator = make_integrator();
      check_given_step(parameters.time, discretization, stage != current.stage);
    });
    current.stage = stage;
  }



  template <int dim>
  void
  Simulation<dim>::next_stage()
  {
    const std::string scheme     = parameters.scheme.stress_update;
    const std::string velocities = parameters.time.velocities;
    const auto       &next       = parameters.stages[current.stage + 1];
    const bool        changes    = parameters.changes_bodies(current.stage + 1);
    const bool        keeps_integrator = scheme == next.scheme.stress_update &&
                                  velocities == next.time.velocities &&
                                  !changes;
    current.n_rejections = 0;
    if (!keeps_integrator)
      {
        integrator->finish(current);
        current.velocity_time = current.time;
        current.step = current.velocity_step = 0.;
      }
    current.reactions = {};
    // The kept acceleration of an implicit scheme is part of its solution.
    AccelerationHistory<dim> kept;
    if (keeps_integrator && is_implicit())
      kept = current.field.history;
    std::vector<const Material *> materials;
    for (const Body<dim> &body : current.bodies)
      materials.push_back(body.material);
    const double energy =
      changes
        ? energy_of_bodies<dim>(current.bodies, discretization.transfer(), comm)
        : 0.;
    enter_stage(current.stage + 1);
    if (changes)
      change_bodies_from(materials, energy);
    check_closed_box(current.bodies, parameters, discretization.space());
    start_stage();
    current.field.history = kept;
  }



  template <int dim>
  void
  Simulation<dim>::change_bodies_from(
    const std::vector<const Material *> &materials, const double energy)
  {
    in_stage(parameters, current.stage, [&]() {
      change_bodies(current, materials, parameters, loads, discretization);
      loads.find_points(current.bodies, comm);
    });
    guard.weigh(current);
    current.energy.add_to_start(
      energy_of_bodies<dim>(current.bodies, discretization.transfer(), comm) -
      energy);
    share_cells();
  }



  template <int dim>
  void
  Simulation<dim>::start_stage()
  {
    // Reset data of other walls, mass or integrators.
    discretization.initialize_field(current);
    current.step_fraction = 1.;
    current.estimates     = StepEstimates();
    current.water_step    = 0.;

    loads.clear(current.bodies);
    loads.surfaces().clear(current.surfaces);
    const bool reset = !parameters.stages.empty() &&
                       parameters.stages[current.stage].reset_displacements;
    const bool has_affine = parameters.scheme.has_affine();
    for_all_points(current, [&](MaterialPoints<dim> &points) {
      const PointField *affine = points.layout().find("affine");
      points.for_each([&](PointRef<dim> p) {
        for (unsigned int d = 0; reset && d < dim; ++d)
          p.reference(d) = p.position(d);
        for (unsigned int k = 0; affine && !has_affine && k < dim * dim; ++k)
          p[affine->first + k] = 0.;
      });
    });
    // This stage may have other loads, and new initial positions.
    loads.precompute(current.bodies);
    current.points_have_changed();

    renew_signals(current, space());
  }



  template void
  Simulation<2>::enter_stage(const unsigned int);
  template void
  Simulation<3>::enter_stage(const unsigned int);
  template void
  Simulation<2>::next_stage();
  template void
  Simulation<3>::next_stage();
  template void
  Simulation<2>::start_stage();
  template void
  Simulation<3>::start_stage();
} // namespace greville

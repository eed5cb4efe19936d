// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/common_step.h>
#include <greville/steps/step_size.h>

// The steps of a simulation, and its return to a good state.
namespace greville
{
  using namespace dealii;

  namespace
  {
    // Steps between two snapshots.
    constexpr unsigned int remember_every = 50;

    // The largest accepted fraction of cells in fragments (lumped mass),
    // relative to cells with points. A larger one causes a warning.
    constexpr double largest_fraction_of_fragments = 0.05;
  } // namespace



  template <int dim>
  bool
  Simulation<dim>::keeps_state() const
  {
    // Implicit steps are few, and runs may go on until no solution exists.
    return current.n_steps == 0 || current.n_steps % remember_every == 0 ||
           is_stage_finished() || is_implicit();
  }



  template <int dim>
  void
  Simulation<dim>::remember()
  {
    if (current.n_steps > 0 && keeps_state())
      last_good.take(current);
    if (programs_have_points)
      current.points_have_changed();
  }



  template <int dim>
  void
  Simulation<dim>::begin_step()
  {
    is_first_step_of_stage = current.n_steps == 0 || is_stage_finished();
    if (is_stage_finished())
      next_stage();
    log.newton.clear();
    current.n_rejections = 0;
  }



  template <int dim>
  void
  Simulation<dim>::take_step(const double dt)
  {
    // The guard checks the energy of the state before the step, which is summed
    // up during the step.
    const bool is_last_step =
      current.n_steps + 1 == parameters.time.max_steps ||
      (current.stage + 1 == parameters.n_stages() && is_end(current.time + dt));
    if (rows_are_late() && !requested_row.is_wanted &&
        (is_last_step || guard.looks_at_energy(current.n_steps + 1)))
      ask_for_row(0.);
    requested_row.is_known = false;
    integrator->advance(current, dt);
    requested_row.is_wanted = false;
    {
      const PartTimer timer(log, "volume of fluids");
      share_volume(current,
                   discretization.transfer(),
                   discretization.cell_size());
    }
    if (parameters.time.largest_displacement > 0.)
      current.displacement = largest_displacement(current.bodies, comm);
    const double fraction = is_first_step_of_stage
                              ? discretization.field().mass->fragment_fraction()
                              : 0.;
    if (fraction > largest_fraction_of_fragments)
      log.warnings.push_back(
        text_of(100. * fraction) +
        " % of the cells with points have lumped mass: the bodies are too thin "
        "there for the exact mass. Take smaller cells.");
    guard.check(current, is_implicit());
    check_energy();
  }



  template <int dim>
  void
  Simulation<dim>::check_energy()
  {
    const bool is_due = guard.looks_at_energy(current.n_steps, is_finished());
    if (is_due && requested_row.is_known)
      {
        const PartTimer timer(log, "energy");
        double          energy = 0.;
        for (unsigned int b = 0; b < current.bodies.size(); ++b)
          for (const auto &lane : {requested_row.sums[b].kinetic,
                                   requested_row.sums[b].strain,
                                   requested_row.sums[b].dissipation})
            energy += requested_row.sums[b].sum(lane);
        guard.set_energy_swing(requested_row.energy_swing);
        guard.check_energy(
          current,
          requested_row.energy.totals(Utilities::MPI::sum(energy, comm), comm));
      }
    else if (is_due && !rows_are_late())
      guard.check_energy(current, energy_totals());
    else if (is_implicit())
      // Compare the energy in each implicit step: a run may have few steps, and
      // loads may appear and vanish between two checks.
      current.energy.remember(energy_totals());
  }



  template <int dim>
  void
  Simulation<dim>::end_step()
  {
    if (current.n_points == 0)
      log.warnings.push_back("The last point has left the grid at t = " +
                             std::to_string(current.time) +
                             " s: the run ends.");
  }



  template <int dim>
  void
  Simulation<dim>::step()
  {
    Require(parameters.contacts.empty(),
            "There are 'Simulation/Contacts': greville::CoupledSimulations "
            "takes the steps of bodies that meet.");
    CommonStep<dim>({this}).take();
  }



  template <int dim>
  void
  Simulation<dim>::restore()
  {
    if (entered_stage != last_good.stage() || !integrator)
      enter_stage(last_good.stage());
    last_good.restore(current);
    requested_row = {};
  }



  template <int dim>
  void
  Simulation<dim>::go_back(const StepFailed &failure, const double dt)
  {
    std::string message = parameters.stage_text(current.stage) + "Step " +
                          std::to_string(current.n_steps + 1) + log.of +
                          " at t = " + text_of(current.time) +
                          " s, dt = " + text_of(dt) +
                          " s: " + without_stop(failure.what()) + ". ";
    if (failure.by_materials)
      message += describe_materials(current.bodies) + " " +
                 loads.describe_large_loads(current.time,
                                            dt,
                                            discretization.cell_size(),
                                            comm);
    restore();
    AssertThrow(false,
                StepGivenUp(message + "The state of step " +
                            std::to_string(current.n_steps) +
                            ", t = " + text_of(current.time) +
                            " s, is the last good state that was kept."));
    // Not reached.
    throw failure;
  }



  GREVILLE_INSTANTIATE_CLASS(Simulation);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/step_errors.h>
#include <greville/base/tables.h>
#include <greville/steps/cell_changes.h>
#include <greville/steps/snapshot.h>
#include <greville/steps/time_integrator.h>

namespace greville
{
  template <int dim>
  class BodyContacts;
  template <int dim>
  class CommonStep;
  template <int dim>
  class PassingBodies;
  template <int dim>
  class TrialContacts;

  /// The material point method on a grid of B-splines: a State on a
  /// Discretization, advanced by a TimeIntegrator. Each stage of the parameters
  /// has its own integrator, walls, mass and loads; State and mesh remain. All
  /// bodies share the grid. CoupledSimulations has one simulation for each
  /// grid.
  template <int dim>
  class Simulation
  {
  public:
    /// Collective. Make grid and points. Throws dealii::ExcMessage for invalid
    /// parameters.
    Simulation(const SimulationParameters &parameters,
               const MPI_Comm              comm = MPI_COMM_WORLD);

    /// Collective. Compute mass and velocity of the grid from the current
    /// points, for output before the first step.
    void
    fill_grid();

    /// Collective. Take one step, not beyond the end. Throws StepGivenUp with
    /// step, time and point if a point is lost or breaks, or if a StepGuard
    /// finds an error. The state is then the last good snapshot, in single
    /// precision; keep a copy of state() if you need an exact one. Several
    /// simulations take a CommonStep.
    void
    step();

    bool
    is_finished() const;

    /// Return whether a point has moved farther than 'Time/Largest
    /// displacement'.
    bool
    exceeds_displacement() const;

    /// Return whether the stage has ended: the next step belongs to the next
    /// stage, if there is one.
    bool
    is_stage_finished() const
    {
      return is_end(current.time);
    }

    /// Return whether the next step first copies the state, to restore it after
    /// a failure.
    bool
    keeps_state() const;

    /// Return the parameters with the sections of the current stage.
    const SimulationParameters &
    stage_parameters() const
    {
      return parameters;
    }

    /// Return the state, a copy of which can be restored later.
    const State<dim> &
    state() const
    {
      return current;
    }

    /// Collective. Continue from a copy of state(). Subsequent results depend
    /// only on the copy: they are bitwise equal each time, on the same number
    /// of processes.
    void
    set_state(const State<dim> &state);

    /// Collective. Before the first step: begin with the points of @p content
    /// instead of the initial ones, see set_points_from_tables().
    void
    begin_with(const TablesFile &content);

    /// Return the grid, with the transfer between grid and points.
    Discretization<dim> &
    grid()
    {
      return discretization;
    }

    const Discretization<dim> &
    grid() const
    {
      return discretization;
    }

    /// Collective. Return a row of statistics.csv for the current state.
    Statistics<dim>
    statistics() const;

    /// Return whether velocities belong to a time before State::time, so that
    /// the next step must sum up a row for this time.
    bool
    rows_are_late() const
    {
      return integrator->velocities_are_late(current);
    }

    /// Collective. Complete the kick of the points, so that velocities belong
    /// to State::time, for results at the end of a run. A failure causes a
    /// warning. Later steps continue from this state.
    void
    finish();

    /// Collective. Call @p show with the state after finish(). Then return to
    /// the state before finish(), as by set_state().
    void
    show_finished(const std::function<void()> &show);

    /// Collective. Request that the next step sums up the row of the current
    /// state, see LateRow; late_statistics() returns it afterwards.
    /// @p outer_mass is the mass of the outermost points that may determine the
    /// run-out. @p watch and @p show are the functions of LateRow. set_state()
    /// and a failed step cancel the request.
    void
    ask_for_row(const double                         outer_mass,
                const decltype(LateRow<dim>::watch) &watch = {},
                const std::function<void()>         &show  = {});

    const LateRow<dim> &
    late_row() const
    {
      return requested_row;
    }

    /// Collective. Return the row that the last step has summed up.
    Statistics<dim>
    late_statistics() const
    {
      return complete(requested_row);
    }

    /// Collective. Return the force on the functions of the grid by stresses,
    /// gravity and loads in the current state, N (2D: N / m).
    VectorField<dim>
    grid_force();

    /// Collective. Return the surfaces with their current loads.
    const std::vector<Surface<dim>> &
    loaded_surfaces();

    const std::vector<Body<dim>> &
    bodies() const
    {
      return current.bodies;
    }

    /// Return the bodies, for programs that change points between steps. Their
    /// number and mass must not change. After the first call, sums over the
    /// points are recomputed in each step.
    std::vector<Body<dim>> &
    bodies();

    const SplineSpace<dim> &
    space() const
    {
      return discretization.space();
    }

    const GridMass<dim> &
    mass() const
    {
      return *discretization.field().mass;
    }

    /// See TimeIntegrator::is_implicit().
    bool
    is_implicit() const
    {
      return integrator->is_implicit();
    }

    /// Collective. Return the energy balance of the current state.
    EnergyTotals
    energy_totals();

    /// See TimeIntegrator::solver_levels().
    std::vector<SolverLevel>
    solver_levels() const
    {
      return integrator->solver_levels();
    }

    /// Return the messages, records of Newton's method, and times of steps.
    StepLog &
    step_log()
    {
      return log;
    }

    /// Collective. Return the positions of the cells that indicators want to be
    /// halved in the current state, see mark_cells().
    std::vector<std::uint64_t>
    marked_cells();

    /// Collective. Return StressJumps::of_points in the current state.
    std::vector<double>
    stress_jumps();

    /// Return the bytes of the points on this process and of the stored state.
    std::size_t
    points_memory() const;

  private:
    friend class BodyContacts<dim>;
    friend class PassingBodies<dim>;
    friend class CommonStep<dim>;
    friend class TrialContacts<dim>;

    // Collective. Return a row, to which the sums over points are added later.
    LateRow<dim>
    begin_row(const double outer_mass) const;
    Statistics<dim>
    complete(const LateRow<dim> &late) const;

    std::unique_ptr<TimeIntegrator<dim>>
    make_integrator();
    // Make the members of a stage; enter the next one; initialize its state.
    void
    enter_stage(const unsigned int stage);
    void
    next_stage();
    void
    start_stage();
    // Collective. Replace bodies and materials of the previous stage by the
    // ones of the current stage. The previous bodies had this energy.
    void
    change_bodies_from(const std::vector<const Material *> &materials,
                       const double                         energy);
    // Change the cells if due. Returns whether the state has changed.
    bool
    change_cells();

    // Share the cells equally among the processes, see CellChanges.
    void
    share_cells();

    // Restart solvers, guard and snapshot from the current state.
    void
    begin_anew();

    // Before a step, copy the state, and begin the next stage if due.
    void
    remember();
    void
    begin_step();

    // Accept the step that has been tried, and do the tasks after it.
    void
    take_step(const double dt);
    bool
    is_end(const double t) const; // of the stage
    void
    check_energy();
    void
    end_step();

    // Collective. Restore the last good state and the parameters of its stage,
    // and throw StepGivenUp with the message for a step of this length.
    void
    restore();
    [[noreturn]] void
    go_back(const StepFailed &failure, const double dt);

    SimulationParameters                 parameters;
    MPI_Comm                             comm;
    StepLog                              log;
    Loads<dim>                           loads;
    Discretization<dim>                  discretization;
    CellChanges<dim>                     cells;
    StepGuard<dim>                       guard;
    LateRow<dim>                         requested_row;
    State<dim>                           current;
    Snapshot<dim>                        last_good;
    std::unique_ptr<TimeIntegrator<dim>> integrator;
    bool         programs_have_points = false, is_first_step_of_stage = false;
    unsigned int entered_stage = 0; // stage of the parameters
  };
} // namespace greville

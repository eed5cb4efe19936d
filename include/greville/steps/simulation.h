// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_simulation_h
#define greville_steps_simulation_h

#include <greville/base/step_errors.h>
#include <greville/base/tables.h>
#include <greville/steps/statistics.h>
#include <greville/steps/step_guard.h>
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

  /**
   * The material point method on a grid of B-splines: a State on a
   * Discretization, which a TimeIntegrator takes from step to step. Each stage
   * of the parameters has its own integrator, walls, mass and loads; State and
   * mesh stay. All bodies share the grid. Those with a grid each are the
   * simulations of CoupledSimulations.
   */
  template <int dim>
  class Simulation
  {
  public:
    /// Collective. Makes grid and points. Throws dealii::ExcMessage where
    /// parameters are wrong.
    Simulation(const SimulationParameters &parameters,
               const MPI_Comm              comm = MPI_COMM_WORLD);

    /// Collective. Mass and velocity of the grid from the points as they are:
    /// for output before the first step.
    void
    fill_grid();

    /// Collective. One step; not beyond the end. Throws StepGivenUp with step,
    /// time and point where a point is lost or breaks, or a StepGuard finds
    /// something wrong; the state is then the last good one that was kept, to
    /// single precision. For an exact one keep a copy of state(). Those of
    /// several simulations are a CommonStep.
    void
    step();

    bool
    is_finished() const;

    /// Collective. Before the first step: see make_later_bodies().
    std::vector<Body<dim>>
    later_bodies();

    /// Whether a point has moved by more than 'Time/Largest displacement'.
    bool
    exceeds_displacement() const;

    /// Whether the stage has come to its end: the next step is the first of the
    /// next stage, if there is one.
    bool
    is_stage_finished() const
    {
      return is_end(current.time);
    }

    /// Whether the next step begins with a copy of the state to go back to.
    bool
    keeps_state() const;

    /// The parameters with the sections of the stage.
    const SimulationParameters &
    stage_parameters() const
    {
      return parameters;
    }

    /// A copy of it is a state to go back to.
    const State<dim> &
    state() const
    {
      return current;
    }

    /// Collective. Go on from a copy of state(). What follows depends on the
    /// copy alone: it has the same bits each time, on as many processes.
    void
    set_state(const State<dim> &state);

    /// Collective. Before the first step: begin with the points of @p content
    /// instead of the initial ones, see set_points_from_tables().
    void
    begin_with(const TablesFile &content);

    /// The grid, and what goes between it and the points.
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

    /// Collective. One row of statistics.csv, of the state as it is.
    Statistics<dim>
    statistics() const;

    /// Whether velocities belong to a time before State::time, so that a row of
    /// this time is to be summed up by the next step.
    bool
    rows_lag() const
    {
      return integrator->velocities_lag(current);
    }

    /// Collective. Give points the rest of their kick, so that velocities
    /// belong to State::time: for what is read at the end of a run. Later steps
    /// go on from there. Where the kick fails, as the next step will do as
    /// well, velocities stay those of State::velocity_time, with a warning.
    void
    finish();

    /// Collective. Ask the next step for the row of the state as it is, see
    /// LateRow; late_row() gives it after the step. @p outer_mass is the mass
    /// of the outermost points that a front may be among, and @p watch as in
    /// LateRow. set_state(), and a step that fails, forget it.
    void
    ask_for_row(const double                         outer_mass,
                const decltype(LateRow<dim>::watch) &watch = {});

    const LateRow<dim> &
    late_row() const
    {
      return asked;
    }

    /// Collective. The row that the last step has summed up.
    Statistics<dim>
    late_statistics() const
    {
      return complete(asked);
    }

    /// Collective. The force on the functions of a velocity field of the grid
    /// by stresses, gravity and loads as they are, N (2D: N / m).
    VectorField<dim>
    grid_force();

    /// Collective. The surfaces, with their loads as they are.
    const std::vector<Surface<dim>> &
    loaded_surfaces();

    const std::vector<Body<dim>> &
    bodies() const
    {
      return current.bodies;
    }

    /// For programs that change points between steps: not their number and
    /// mass. From now on, sums over the points are made anew in each step.
    std::vector<Body<dim>> &
    bodies()
    {
      programs_have_points = true;
      current.points_have_changed();
      return current.bodies;
    }

    const SplineSpace<dim> &
    space() const
    {
      return discretization.space();
    }

    /// The mass of the first velocity field: those of others are of the same
    /// kind.
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

    /// Collective. The balance of energy of the state as it is.
    EnergyTotals
    energy_totals();

    /// See TimeIntegrator::solver_levels().
    std::vector<SolverLevel>
    solver_levels() const
    {
      return integrator->solver_levels();
    }

    /// Words for messages and Newton's log, such as " of 'Body disk'".
    void
    set_label(const std::string &of)
    {
      log.of = of;
    }

    /// Warnings since the last call.
    std::vector<std::string>
    take_warnings();

    /// What Newton's method has done in the last step, once.
    std::vector<NewtonRecord>
    take_newton();

    /// Seconds on this process that each task of a step has taken.
    const std::map<std::string, double> &
    part_times() const
    {
      return log.seconds;
    }

    /// The work of this process in a step, see work_of_process().
    double
    work() const;

    /// Collective. Share the cells among the processes so that each has the
    /// same share of the work as it is now, between two steps. Spaces and
    /// masses are new then; results change by tolerances of solvers.
    void
    share_cells();

    /// Bytes of the points on this process and of the state to go back to.
    std::size_t
    points_memory() const;

  private:
    friend class BodyContacts<dim>;
    friend class PassingBodies<dim>;
    friend class CommonStep<dim>;
    friend class TrialContacts<dim>;

    // Collective. A row before points are summed up, and with the sums.
    LateRow<dim>
    begin_row(const double outer_mass) const;
    Statistics<dim>
    complete(const LateRow<dim> &late) const;

    // Make all that depends on the sections of a stage; go on from the state at
    // the end of a stage with the next one; what the state has at its start.
    void
    enter_stage(const unsigned int stage);
    void
    next_stage();
    void
    start_stage();
    // Collective. Bodies and materials of the stage, in the place of those of
    // the one before, whose bodies had this energy.
    void
    change_bodies_from(const std::vector<const Material *> &materials,
                       const double                         energy);
    // share_cells() where it is due before this step; whether it is.
    bool
    balance_load();

    // What is due before a step: a copy to go back to, and the next stage.
    void
    remember();
    void
    begin_step();

    // Take the step that has been tried, and what is due after all have.
    void
    take_step(const double dt);
    bool
    is_end(const double t) const; // of the stage
    bool
    is_last_step(const double dt) const;
    void
    check_energy();
    void
    end_step();

    // Collective. Go back to the last good state, and to the sections of its
    // stage; and throw, as StepGivenUp, the message of a step of this length.
    void
    restore();
    [[noreturn]] void
    go_back(const StepFailed &failure, const double dt);
    void
    check_fragments();

    SimulationParameters                 parameters;
    MPI_Comm                             comm;
    StepLog                              log;
    Loads<dim>                           loads;
    Discretization<dim>                  discretization;
    StepGuard<dim>                       guard;
    LateRow<dim>                         asked;
    State<dim>                           current;
    Snapshot<dim>                        good;
    std::unique_ptr<TimeIntegrator<dim>> integrator;
    bool                                 programs_have_points = false;

    // The step at hand.
    bool         is_first_step_of_stage = false;
    unsigned int entered_stage          = 0; // that of the parameters
  };
} // namespace greville

#endif

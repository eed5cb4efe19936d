// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_simulation_h
#define greville_steps_simulation_h

#include <greville/base/step_errors.h>
#include <greville/base/tables.h>
#include <greville/steps/damping.h>
#include <greville/steps/end_of_step.h>
#include <greville/steps/statistics.h>
#include <greville/steps/step_guard.h>
#include <greville/steps/time_integrator.h>

namespace greville
{
  /**
   * The material point method on a grid of B-splines: a State on a
   * Discretization, which a TimeIntegrator takes from step to step. Each stage
   * of the parameters has its own integrator, walls, mass and loads; State and
   * mesh stay.
   *
   * All bodies share the grid. Those with a grid each are the simulations of an
   * Ensemble.
   */
  template <int dim>
  class Simulation
  {
  public:
    /**
     * Collective. Makes grid and points. Throws dealii::ExcMessage where
     * parameters are wrong.
     */
    Simulation(const SimulationParameters &parameters,
               const MPI_Comm              comm = MPI_COMM_WORLD);

    /**
     * Collective. Mass and velocity of the grid from the points as they are:
     * for output before the first step.
     */
    void
    fill_grid();

    /**
     * Collective. One step; not beyond the end. Throws StepGivenUp with step,
     * time and point where a point is lost or breaks, or a StepGuard finds
     * something wrong; the state is then the last good one that was kept, to
     * single precision. For an exact one keep a copy of state().
     */
    void
    step();

    /**
     * Collective. step() of several simulations of the same times and stages
     * that do not see one another, as long as the shortest that one of them
     * proposes. Where one rejects it, all of them try a shorter one; where one
     * fails, all of them go back.
     */
    static void
    step_together(const std::vector<Simulation *> &simulations);

    bool
    is_finished() const;

    /**
     * Whether a point has moved by more than 'Time/Largest displacement'.
     */
    bool
    exceeds_displacement() const;

    /**
     * Whether the stage has come to its end: the next step is the first of the
     * next stage, if there is one.
     */
    bool
    is_stage_finished() const;

    /**
     * Whether the next step begins with a copy of the state to go back to.
     */
    bool
    keeps_state() const;

    /**
     * The parameters with the sections of the stage.
     */
    const SimulationParameters &
    stage_parameters() const
    {
      return parameters;
    }

    /**
     * A copy of it is a state to go back to.
     */
    const State<dim> &
    state() const
    {
      return current;
    }

    /**
     * Collective. Go on from a copy of state() of this simulation. What follows
     * depends on the copy alone: it has the same bits each time, on the same
     * number of processes.
     */
    void
    set_state(const State<dim> &state);

    /**
     * Collective. Begin with the points that bodies and surfaces of the same
     * name have in @p content instead of the initial ones, see
     * set_points_from_tables(): before the first step.
     */
    void
    begin_with(const TablesFile &content);

    /**
     * The grid, and what goes between it and the points.
     */
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

    /**
     * Collective. One row of statistics.csv, of the state as it is.
     */
    Statistics<dim>
    statistics() const;

    /**
     * Collective. The force on the functions of a velocity field of the grid by
     * stresses, gravity and loads as they are, N (2D: N / m).
     */
    VectorField<dim>
    grid_force(const unsigned int field = 0);

    /**
     * Collective. The surfaces, with their loads as they are.
     */
    const std::vector<Surface<dim>> &
    loaded_surfaces();

    const std::vector<Body<dim>> &
    bodies() const
    {
      return current.bodies;
    }

    /**
     * For programs that change points between steps: not their number and
     * mass. From now on, sums over the points are made anew in each step.
     */
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

    /**
     * The mass of the first velocity field: those of others are of the same
     * kind.
     */
    const GridMass<dim> &
    mass() const
    {
      return *discretization.fields()[0].mass;
    }

    /**
     * See TimeIntegrator::is_implicit().
     */
    bool
    is_implicit() const
    {
      return integrator->is_implicit();
    }

    /**
     * Collective. The balance of energy at the end of the step: velocities
     * belong to State::time.
     */
    EnergyTotals
    energy_totals();

    /**
     * See TimeIntegrator::solver_levels().
     */
    std::vector<SolverLevel>
    solver_levels() const
    {
      return integrator->solver_levels();
    }

    /**
     * Words for messages and Newton's log, such as " of 'Body disk'", which
     * tell it from other simulations.
     */
    void
    set_label(const std::string &of)
    {
      log.of = of;
    }

    /**
     * Warnings since the last call.
     */
    std::vector<std::string>
    take_warnings();

    /**
     * What Newton's method has done in the last step, once.
     */
    std::vector<NewtonRecord>
    take_newton();

    /**
     * Seconds on this process that each task of a step has taken.
     */
    const std::map<std::string, double> &
    part_times() const
    {
      return log.seconds;
    }

    /**
     * The work of this process in a step, see work_of_process().
     */
    double
    work() const;

    /**
     * Collective. Share the cells among the processes so that each has the same
     * share of the work as it is now, between two steps. Spaces and masses are
     * others after that. The results do not depend on it but by round-off and
     * the tolerances of solvers.
     */
    void
    share_cells();

    /**
     * Bytes of the points on this process, with those of the state to go back
     * to.
     */
    std::size_t
    points_memory() const;

  private:
    friend class EndOfStep<dim>;

    /**
     * Collective. Give the state what it lacks for output, see EndOfStep, with
     * the time of @p part. Returns whether end_output() has to take it back.
     */
    bool
    begin_output(const std::string &part);

    void
    end_output();

    /**
     * Make all that depends on the sections of a stage.
     */
    void
    enter_stage(const unsigned int stage);

    /**
     * Go on from the state at the end of a stage with the next one.
     */
    void
    next_stage();

    /**
     * What the state has at the start of a stage.
     */
    void
    start_stage();

    /**
     * share_cells() where the parameters want it before this step. Returns
     * whether they do.
     */
    bool
    balance_load();

    /**
     * What is due before a step: a copy to go back to, and the next stage.
     */
    void
    remember();

    void
    begin_step();

    void
    propose();

    /**
     * Propose another step after one that has been rejected.
     */
    void
    propose_again(const StepRejected &rejection);

    /**
     * Take the step that has been tried.
     */
    void
    take_step(const double dt);

    /**
     * What is due after all have taken it.
     */
    void
    end_step();

    /**
     * Collective. Go back to the last good state, and to the sections of its
     * stage.
     */
    void
    restore();

    /**
     * Go back and throw, as StepGivenUp, the message of a step of the length @p
     * dt.
     */
    [[noreturn]] void
    go_back(const StepFailed &failure, const double dt);

    /**
     * Warn where much of the bodies is too thin for the exact mass.
     */
    void
    check_fragments();

    SimulationParameters                 parameters;
    MPI_Comm                             comm;
    StepLog                              log;
    Loads<dim>                           loads;
    Discretization<dim>                  discretization;
    Damping<dim>                         damping;
    StepGuard<dim>                       guard;
    State<dim>                           current;
    Snapshot<dim>                        good;
    std::unique_ptr<TimeIntegrator<dim>> integrator;
    UnfinishedState<dim>                 unfinished; // during output
    bool                                 programs_have_points = false;

    // The step at hand.
    double       proposed               = 0.; // s
    bool         is_first_step_of_stage = false;
    unsigned int entered_stage          = 0; // that of the parameters
  };
} // namespace greville

#endif

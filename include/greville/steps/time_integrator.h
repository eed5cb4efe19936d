// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_time_integrator_h
#define greville_steps_time_integrator_h

#include <greville/parameters/names.h>
#include <greville/steps/late_row.h>
#include <greville/steps/step_guard.h>

#include <functional>

namespace greville
{
  template <int dim>
  class ImplicitSteps;

  /**
   * A level of the solver of an integrator.
   */
  struct SolverLevel
  {
    unsigned int  degree;
    std::uint64_t n_unknowns;
    std::string   method;
  };



  /**
   * A scheme that takes a State from t to t + dt. It owns what it needs to try
   * a step; all that a step hands to the next one is in the state, so that a
   * copy of the state is enough to go back.
   *
   * A new integrator is a class that derives from this one, and one line in the
   * list of source/steps/time_integrator.cc; or a call of
   * add_time_integrator() in a program.
   */
  template <int dim>
  class TimeIntegrator
  {
  public:
    virtual ~TimeIntegrator() = default;

    /**
     * Collective. The length of the next step, s. Estimates in the state are
     * renewed where they are due, and after a step that has been rejected
     * (StateWithoutBodies::n_rejections). Throws dealii::ExcMessage where
     * parameters do not give a step.
     */
    virtual double
    propose_step(State<dim> &state) = 0;

    /**
     * Collective. Try a step, and keep what advance() needs of it. Throws
     * StepRejected where a shorter one is to be tried. Positions, velocities,
     * stresses, time and counters do not change, only guesses may: a scheme
     * that iterates does so on fields of its own. The step may be tried again
     * with another length, as where simulations go in common steps. Throws
     * StepFailed where a solver does not converge.
     */
    virtual void
    try_step(State<dim> &, const double)
    {}

    /**
     * Collective. Take the step that has been tried last: the state at t + @p
     * dt, with the points in their cells. Throws StepFailed where a solver does
     * not converge, or a point breaks or leaves the grid.
     */
    virtual void
    advance(State<dim> &state, const double dt) = 0;

    /**
     * Forget what earlier steps have left, so that the next one depends on the
     * state alone, to the bit.
     */
    virtual void
    forget()
    {}

    /**
     * Whether velocities belong to a time before State::time, until finish()
     * changes that. advance() sums up the LateRow of the state before the step
     * then, where it is wanted.
     */
    virtual bool
    velocities_lag(const State<dim> &) const
    {
      return false;
    }

    /**
     * Collective. Let velocities, and coefficients of the grid, belong to
     * State::time: for a stage with another integrator, and the last row.
     * Throws StepFailed.
     */
    virtual void
    finish(State<dim> &)
    {}

    /**
     * Whether it has no critical step. Then points may cross many cells in a
     * step, and momentum is what the grid gives to them, to the tolerance of a
     * solver (see StepGuard); cells count as filled by the threshold of
     * ImplicitParameters; and each step begins with a copy of the state to go
     * back to.
     */
    virtual bool
    is_implicit() const
    {
      return false;
    }

    /**
     * Return it as the steps that 'Simulation/Contacts' can couple by one
     * Newton's method; null otherwise.
     */
    virtual ImplicitSteps<dim> *
    implicit_steps()
    {
      return nullptr;
    }

    /**
     * The levels of its solver, the coarsest first; none where it solves with
     * the mass of the Discretization only.
     */
    virtual std::vector<SolverLevel>
    solver_levels() const
    {
      return {};
    }
  };



  /**
   * What integrators are made with. All are kept by reference. The guard looks
   * at what they tell it of a step.
   */
  template <int dim>
  struct IntegratorParts
  {
    const SimulationParameters &parameters;
    Discretization<dim>        &discretization;
    Loads<dim>                 &loads;
    const State<dim>           &initial;
    StepLog                    &log;
    StepGuard<dim>             &guard;
    LateRow<dim>               &late_row;
  };

  template <int dim>
  using MakeTimeIntegrator = std::function<std::unique_ptr<TimeIntegrator<dim>>(
    const IntegratorParts<dim> &parts)>;

  /**
   * Add one to the list, before parameters are read.
   */
  template <int dim>
  void
  add_time_integrator(const std::string             &name,
                      const MakeTimeIntegrator<dim> &make);

  /**
   * An integrator by name. Throws dealii::ExcMessage for an unknown one.
   */
  template <int dim>
  std::unique_ptr<TimeIntegrator<dim>>
  make_time_integrator(const std::string          &name,
                       const IntegratorParts<dim> &parts);
} // namespace greville

#endif

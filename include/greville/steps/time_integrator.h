// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/parameters/names.h>
#include <greville/steps/step_guard.h>

#include <functional>

namespace greville
{
  template <int dim>
  class ImplicitSteps;

  /// A level of the solver of an integrator.
  struct SolverLevel
  {
    unsigned int  degree;
    std::uint64_t n_unknowns;
    std::string   method;
  };



  /**
   * Base class of schemes that advance a State from t to t + dt. A scheme owns
   * the data of a trial step. All data that a step passes to the next one are
   * in the state, so that a copy of the state suffices to restore it.
   *
   * A new integrator is a class that derives from this one, and one line in the
   * list of source/steps/time_integrator.cc; or a call of add_time_integrator()
   * in a program.
   */
  template <int dim>
  class TimeIntegrator
  {
  public:
    virtual ~TimeIntegrator() = default;

    /// Collective. Return the length of the next step, s. Estimates in the
    /// state are renewed if they are due, and after a rejected step
    /// (StateWithoutBodies::n_rejections). Throws dealii::ExcMessage if
    /// parameters do not give a step.
    virtual double
    propose_step(State<dim> &state) = 0;

    /// Collective. Try a step, and store the data for advance(). Throws
    /// StepRejected if a shorter step should be tried. It may change only the
    /// guesses in the state, not positions, velocities, stresses, time and
    /// counters; a scheme that iterates therefore needs fields of its own. The
    /// step may be tried again with another length, as in common steps of
    /// simulations. Throws StepFailed if a solver does not converge.
    virtual void
    try_step(State<dim> &, const double)
    {}

    /// Collective. Accept the last trial: set the state at t + @p dt, with the
    /// points in their cells. Throws StepFailed if a solver does not converge,
    /// or a point breaks or leaves the grid.
    virtual void
    advance(State<dim> &state, const double dt) = 0;

    /// Discard data of earlier steps, so that the next step depends bitwise
    /// only on the state.
    virtual void
    forget()
    {}

    /// Return whether velocities belong to a time before State::time, until
    /// finish() changes this. advance() then sums up the LateRow of the state
    /// before the step, if it is requested.
    virtual bool
    velocities_are_late(const State<dim> &) const
    {
      return false;
    }

    /// Collective. Advance velocities and coefficients of the grid to
    /// State::time, for a stage with another integrator and for the last row.
    /// Throws StepFailed.
    virtual void
    finish(State<dim> &)
    {}

    /// Return whether the scheme has no critical step. If so, points may cross
    /// many cells in a step; momentum is checked against the grid's transfer to
    /// the points, within the tolerance of a solver (see StepGuard); cells
    /// count as filled by the threshold of ImplicitParameters; and each step
    /// begins with a copy of the state for restoring it.
    virtual bool
    is_implicit() const
    {
      return false;
    }

    /// Return the integrator if 'Simulation/Contacts' can couple its steps by a
    /// common Newton's method, otherwise null.
    virtual ImplicitSteps<dim> *
    implicit_steps()
    {
      return nullptr;
    }

    /// Return the levels of its solver, the coarsest first; none if it solves
    /// only with the mass of the Discretization.
    virtual std::vector<SolverLevel>
    solver_levels() const
    {
      return {};
    }
  };



  /// The arguments for making integrators. All are kept by reference.
  /// Integrators pass data of a step to the guard, which checks them.
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

  /// Add an integrator to the list, before parameters are read.
  template <int dim>
  void
  add_time_integrator(const std::string             &name,
                      const MakeTimeIntegrator<dim> &make);

  /// Make an integrator by name. Throws dealii::ExcMessage if it is unknown.
  template <int dim>
  std::unique_ptr<TimeIntegrator<dim>>
  make_time_integrator(const std::string          &name,
                       const IntegratorParts<dim> &parts);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// The changes of the cells between two steps: their distribution among the
  /// processes, and the adaptation of refined grids. The state moves to the new
  /// cells.
  template <int dim>
  class CellChanges
  {
  public:
    /// All arguments are kept by reference. @p release destroys all objects
    /// that refer to the spaces of the @p discretization; it is called before
    /// they are made anew.
    CellChanges(const SimulationParameters  &parameters,
                Discretization<dim>         &discretization,
                StepLog                     &log,
                const std::function<void()> &release);

    /// Collective. Redistribute the cells, so that each process has the same
    /// share of the current work. Spaces and masses are made anew; results
    /// change within solver tolerances.
    void
    share(State<dim> &state);

    /// Collective. Call adapt_grid() and share() if they are due before the
    /// next step. Returns whether the state has changed.
    bool
    take(State<dim> &state);

  private:
    bool
    adapt(State<dim> &state);

    bool
    balance(State<dim> &state);

    const SimulationParameters &parameters;
    Discretization<dim>        &discretization;
    StepLog                    &log;
    const std::function<void()> release;
  };
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/adapt_grid.h>
#include <greville/steps/cell_changes.h>
#include <greville/steps/initial_state.h>
#include <greville/steps/load_balance.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Cells are redistributed if the imbalance exceeds its value after the last
    // redistribution by this factor.
    constexpr double worth_it = 1.05;
  } // namespace



  template <int dim>
  CellChanges<dim>::CellChanges(const SimulationParameters  &parameters,
                                Discretization<dim>         &discretization,
                                StepLog                     &log,
                                const std::function<void()> &release)
    : parameters(parameters)
    , discretization(discretization)
    , log(log)
    , release(release)
  {}



  template <int dim>
  void
  CellChanges<dim>::share(State<dim> &state)
  {
    const MPI_Comm comm      = discretization.communicator();
    const auto     partition = std::make_shared<const Partition>(
      balanced_partition(state, discretization.space()).rows,
      comm,
      state.partition->cells);
    if (Utilities::MPI::n_mpi_processes(comm) == 1 ||
        partition->is_same(*state.partition))
      return;
    release();
    redistribute(state, discretization, partition);
    ++state.n_partitions;
    state.imbalance =
      imbalance(work_of_process(state, discretization.space()), comm);
  }



  template <int dim>
  bool
  CellChanges<dim>::balance(State<dim> &state)
  {
    const MPI_Comm comm      = discretization.communicator();
    const double   threshold = parameters.load_balance.threshold;
    if (Utilities::MPI::n_mpi_processes(comm) == 1 || state.n_steps == 0 ||
        threshold == 0. ||
        state.n_steps % parameters.load_balance.steps_between_comparisons() !=
          0)
      return false;
    const PartTimer timer(log, "load balance");
    // With few cells, no partition may fall below the threshold.
    if (threshold > 1. &&
        imbalance(work_of_process(state, discretization.space()), comm) <=
          std::max(threshold, worth_it * state.imbalance))
      return false;
    share(state);
    return true;
  }



  template <int dim>
  bool
  CellChanges<dim>::adapt(State<dim> &state)
  {
    const unsigned int every = parameters.grid.adapt_every;
    if (every == 0 || state.n_steps == 0 || state.n_steps % every != 0)
      return false;
    const PartTimer  timer(log, "adaptation");
    const Adaptation result =
      adapt_grid(state, discretization, parameters, release);
    if (result.is_limited && !state.is_limited)
      log.warnings.push_back(
        "The limit 'Grid/Most cells' = " +
        std::to_string(parameters.grid.most_cells) +
        " is near at t = " + text_of(state.time) +
        " s: indicators halve fewer cells than they would.");
    state.is_limited = state.is_limited || result.is_limited;
    state.n_divided += result.n_divided;
    if (!result.changes_cells)
      return result.n_divided > 0;
    ++state.n_adaptations;
    share(state);
    renew_signals(state, discretization.space());
    const double first_step    = state.estimates.first_step;
    state.estimates            = StepEstimates();
    state.estimates.first_step = first_step;
    return true;
  }



  template <int dim>
  bool
  CellChanges<dim>::take(State<dim> &state)
  {
    return adapt(state) || balance(state);
  }



  GREVILLE_INSTANTIATE_CLASS(CellChanges);
} // namespace greville

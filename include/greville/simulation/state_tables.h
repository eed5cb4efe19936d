// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_state_tables_h
#define greville_simulation_state_tables_h

#include <greville/base/tables.h>
#include <greville/simulation/discretization.h>

namespace greville
{
  /**
   * Collective. All numbers of a state as tables that do not depend on how
   * cells are shared among processes: a row of points begins with the
   * lexicographic position of its cell (Lattice::n_cells()), one of
   * coefficients with that of its B-spline (SplineSpace::n_functions()). Their
   * names are `state`, `step_estimates`, `body_K`, `surface_K` and those of
   * fields of the grid.
   *
   * What is only a guess for the first iteration of a solver
   * (StateWithoutBodies::slid) is left out.
   */
  template <int dim>
  std::vector<DistributedTable>
  make_tables(const State<dim> &state, const SplineSpace<dim> &space);



  /**
   * Collective. Overwrite @p state, one of the same bodies and surfaces on
   * @p discretization, with what make_tables() made of another one, perhaps on
   * other processes. Points of a cell keep their order, so that on the same
   * number of processes the result has the same bits whoever has the rows.
   * Throws dealii::ExcMessage where bodies, surfaces or the numbers of their
   * points are others.
   */
  template <int dim>
  void
  set_from_tables(State<dim>          &state,
                  const TablesFile    &content,
                  Discretization<dim> &discretization);
} // namespace greville

#endif

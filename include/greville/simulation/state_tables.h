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
   * coefficients with that of its B-spline (SplineSpace::n_functions()).
   *
   * Points have tables `body NAME` and `surface NAME`. Those of the rest begin
   * with the @p prefix: `state` and `step_estimates` with numbers, and those of
   * fields of the grid.
   *
   * What is only a guess for the first iteration of a solver
   * (StateWithoutBodies::slid) is left out.
   */
  template <int dim>
  std::vector<DistributedTable>
  make_tables(const State<dim>       &state,
              const SplineSpace<dim> &space,
              const std::string      &prefix = "");



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
                  Discretization<dim> &discretization,
                  const std::string   &prefix = "");



  /**
   * Collective. Give the bodies and surfaces of @p state, the initial one of
   * another simulation, the points of those of the same name in @p content. The
   * grid, and what else begins anew, may be another one. What loads and APIC
   * keep at points is zero where the other simulation did not have it. Throws
   * dealii::ExcMessage where a body or surface is not there, has another
   * material, or does not lie in the grid.
   */
  template <int dim>
  void
  set_points_from_tables(State<dim>          &state,
                         const TablesFile    &content,
                         Discretization<dim> &discretization);
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_state_tables_h
#define greville_steps_state_tables_h

#include <greville/base/tables.h>
#include <greville/steps/discretization.h>

namespace greville
{
  /**
   * Collective. All numbers of a state as tables that do not depend on how
   * cells are shared among processes: a row of points begins with the
   * lexicographic position of its cell (SplineSpace::owned_cells()), one of
   * coefficients with that of its B-spline (SplineSpace::n_functions()).
   *
   * Points have tables `body NAME` and `surface NAME`. Those of the rest begin
   * with the @p prefix: `state` and `step_estimates` with numbers, `partition`
   * (see Partition), and those of fields of the grid.
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
   *
   * Cells are shared as they were there: the discretization is made anew where
   * they are shared otherwise. A simulation takes that up in
   * Simulation::set_state().
   *
   * With @p stages, points get the layout of the stage that was at hand.
   */
  template <int dim>
  void
  set_from_tables(State<dim>                 &state,
                  const TablesFile           &content,
                  Discretization<dim>        &discretization,
                  const std::string          &prefix = "",
                  const SimulationParameters *stages = nullptr);



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



  /**
   * Collective. The fields of the grid alone, as make_tables() has them.
   */
  template <int dim>
  std::vector<DistributedTable>
  make_field_tables(const State<dim>       &state,
                    const SplineSpace<dim> &space,
                    const std::string      &prefix = "");

  template <int dim>
  void
  set_fields_from_tables(State<dim>          &state,
                         const TablesFile    &content,
                         Discretization<dim> &discretization,
                         const std::string   &prefix = "");



  /**
   * Call @p action(point) for the points of a cell in the order in which
   * MaterialPoints::insert() makes the same lists of them.
   */
  template <int dim, typename Action>
  void
  for_each_as_inserted(const MaterialPoints<dim> &points,
                       const unsigned int         cell,
                       const Action              &action)
  {
    std::vector<unsigned int> groups;
    for (unsigned int g = points.first_group(cell);
         g != MaterialPoints<dim>::none;
         g = points.next_group(g))
      groups.push_back(g);
    for (unsigned int k = groups.size(); k-- > 0;)
      for (unsigned int lane = 0; lane < (k == 0 ? points.n_in_first_group(cell)
                                                 : MaterialPoints<dim>::width);
           ++lane)
        action(points.point(groups[k], lane));
  }
} // namespace greville

#endif

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/tables.h>
#include <greville/steps/discretization.h>

namespace greville
{
  /**
   * Collective. Return all numbers of a state as tables that do not depend on
   * the distribution of cells among processes: a row of a point begins with the
   * lexicographic position of its cell (SplineSpace::owned_cells()), a row of
   * coefficients with the position of their B-spline
   * (SplineSpace::n_functions()).
   *
   * Points have tables `body NAME` and `surface NAME`. The names of all other
   * tables begin with the @p prefix: `state` and `step_estimates` with numbers,
   * `partition`, `refined_cells` and `refined_at_surfaces` (see Partition), and
   * the fields of the grid.
   */
  template <int dim>
  std::vector<DistributedTable>
  make_tables(const State<dim>       &state,
              const SplineSpace<dim> &space,
              const std::string      &prefix = "");



  /**
   * Collective. Overwrite @p state, with the same bodies and surfaces on
   * @p discretization, by the tables of make_tables(), possibly from another
   * number of processes. Points of a cell keep their order. On the same number
   * of processes, the result is therefore bitwise equal regardless of which
   * process has the rows. Throws dealii::ExcMessage if bodies, surfaces or the
   * numbers of their points differ.
   *
   * The distribution of cells is restored: the discretization is made anew if
   * it differs. A simulation accounts for this in Simulation::set_state().
   *
   * With @p stages, points have the layout of the stage of the tables.
   */
  template <int dim>
  void
  set_from_tables(State<dim>                 &state,
                  const TablesFile           &content,
                  Discretization<dim>        &discretization,
                  const std::string          &prefix = "",
                  const SimulationParameters *stages = nullptr);



  /// Collective. Replace the points of bodies and surfaces in @p state by the
  /// points of the same names in @p content, which is from another simulation.
  /// The grid and all other initial data may differ. Point data of loads and
  /// APIC are zero if the other simulation did not have them. Throws
  /// dealii::ExcMessage if a body or surface is missing, has another material,
  /// or is not inside the grid.
  template <int dim>
  void
  set_points_from_tables(State<dim>          &state,
                         const TablesFile    &content,
                         Discretization<dim> &discretization);



  /// Collective. Return only the fields of the grid, in the format of
  /// make_tables().
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



  /// Call @p action(point) for the points of a cell, in an order from which
  /// MaterialPoints::insert() makes the same lists.
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

// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_steps_load_balance_h
#define greville_steps_load_balance_h

#include <greville/steps/discretization.h>

namespace greville
{
  /**
   * The work of this process in a step, in units of that of a point: its points
   * of bodies and surfaces, and its cells.
   */
  template <int dim>
  double
  work_of_process(const State<dim> &state, const SplineSpace<dim> &space);



  /**
   * Collective. The largest work of a process over the mean: the time of a step
   * over that of perfectly shared work, as far as it is in proportion to
   * points and cells.
   */
  double
  imbalance(const double work, const MPI_Comm comm);



  /**
   * Collective. The partition for owned cells of @p space with so many points
   * each.
   */
  template <int dim>
  Partition
  partition_by_points(const std::vector<std::uint64_t> &counts,
                      const SplineSpace<dim>           &space);

  /**
   * Collective. The partition that gives each process the same share of the
   * work.
   */
  template <int dim>
  Partition
  balanced_partition(const State<dim> &state, const SplineSpace<dim> &space);



  /**
   * Collective. Share the cells of @p mesh by @p partition.
   */
  template <int dim>
  void
  repartition_mesh(DistributedTriangulation<dim> &mesh,
                   const Partition               &partition);



  /**
   * Collective. Share the cells by @p partition, make the discretization anew
   * on them, and bring all of @p state there. Points that stay on their process
   * are copied; those that change it are all that is sent besides the fields of
   * the grid.
   *
   * Spaces and masses of the discretization are others after that, as after
   * Discretization::reinit(): whoever refers to them is made anew.
   */
  template <int dim>
  void
  redistribute(State<dim>                             &state,
               Discretization<dim>                    &discretization,
               const std::shared_ptr<const Partition> &partition);
} // namespace greville

#endif

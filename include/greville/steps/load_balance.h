// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/steps/discretization.h>

namespace greville
{
  /// Return the work of this process in a step, for its points of bodies and
  /// surfaces and its cells. Unit: the work of one point.
  template <int dim>
  double
  work_of_process(const State<dim> &state, const SplineSpace<dim> &space);



  /// Collective. Return the largest work of a process over the mean work. As
  /// far as time is proportional to work, a step takes this factor longer than
  /// with balanced work.
  double
  imbalance(const double work, const MPI_Comm comm);



  /// Collective. Return the partition by numbers of points in owned cells.
  template <int dim>
  Partition
  partition_by_points(const std::vector<std::uint64_t> &counts,
                      const SplineSpace<dim>           &space);

  /// Collective. Return the partition with equal work on all processes.
  template <int dim>
  Partition
  balanced_partition(const State<dim> &state, const SplineSpace<dim> &space);



  /// Collective. Distribute the cells of @p mesh by @p partition.
  template <int dim>
  void
  repartition_mesh(DistributedTriangulation<dim> &mesh,
                   const Partition               &partition);



  /**
   * Collective. Distribute the cells by @p partition, make the discretization
   * anew on them, and transfer @p state. Only points that change their process
   * and the fields of the grid are sent; other points are copied.
   *
   * Spaces and masses of the discretization are replaced, as by
   * Discretization::reinit(): objects that refer to them must be made anew.
   */
  template <int dim>
  void
  redistribute(State<dim>                             &state,
               Discretization<dim>                    &discretization,
               const std::shared_ptr<const Partition> &partition);
} // namespace greville

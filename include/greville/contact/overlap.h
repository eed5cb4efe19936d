// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>

#include <greville/spline/cell_box.h>

#include <vector>

namespace greville
{
  /// A material point of one of two sides, with its current volume, m^3 (2D:
  /// m^2, also in axisymmetry).
  template <int dim>
  struct VolumePoint
  {
    dealii::Point<dim> x;
    double             volume = 0.;
    unsigned int       side   = 0;
    unsigned int       body   = 0;
  };



  /// The point with the largest overlap of two bodies.
  template <int dim>
  struct Overlap
  {
    /// e, see largest_overlap(); 0 if nothing overlaps.
    double excess = 0.;
    /// A point of this side and body, m.
    dealii::Point<dim> x;
    unsigned int       side = 0, body = 0;
  };



  /**
   * Collective. Find where points of two sides occupy the same space. Hat
   * functions @f$\psi_i@f$ of a lattice with cells of the size h (m) give the
   * volume fractions of the sides A and B, and their sum at a point x,
   * @f[
   *   \phi^s_i = \frac{1}{\prod_d h_d} \sum_{p \in s} V_p \psi_i(x_p), \qquad
   *   e(x) = \sum_i \psi_i(x)
   *     \left(\min(1, \phi^A_i) + \min(1, \phi^B_i)\right) - 1.
   * @f]
   * Two plane surfaces that touch have e = 0, and an overlap of half of a cell
   * has e between 0.25 and 0.44. Returns the point with the largest e.
   */
  template <int dim>
  Overlap<dim>
  largest_overlap(const std::vector<VolumePoint<dim>> &points,
                  const dealii::Tensor<1, dim>        &h,
                  const MPI_Comm                       comm);

  /// Collective. Do the same with cells between the @p edges. The volume
  /// fraction at a node is relative to the integral of its hat function.
  template <int dim>
  Overlap<dim>
  largest_overlap(const std::vector<VolumePoint<dim>> &points,
                  const CellEdges<dim>                &edges,
                  const MPI_Comm                       comm);
} // namespace greville

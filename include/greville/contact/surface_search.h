// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/mpi.h>

#include <greville/contact/contact_point.h>

#include <vector>

namespace greville
{
  /**
   * A search for gaps between the points of two surfaces, each of which is
   * given only by its points x_k with normals n_k and areas a_k. It uses the
   * implicit surface of moving least squares
   * @f[
   *   \varphi(y) = \frac{1}{2} \sum_k w_k (y - x_k) \cdot n_k
   *     + \frac{1}{2} (y - \sum_k w_k x_k) \cdot n, \qquad
   *   n = \frac{\sum_k w_k n_k}{|\sum_k w_k n_k|}, \qquad
   *   w_k = \frac{a_k r_k^{1 - d} \omega(|y - x_k| / r_k)}
   *              {\sum_l a_l r_l^{1 - d} \omega(|y - x_l| / r_l)},
   * @f]
   * with @f$\omega(s) = (1 - s^2)^2@f$ and r_k equal to two spacings of points:
   * their largest spacing in units of ContactPoint::cell_size, times this size
   * at the point k. (The zero set of the first term alone lies outside a curved
   * surface by the mean sagitta, the zero set of the second term inside by the
   * same amount: on a circle with points all around y, their mean is exact.) A
   * point x is projected onto it along n. Only points whose normals are within
   * 60 degrees of the normal of the nearest point facing x are used, so that
   * edges are not rounded, and only places covered by points are accepted, so
   * that a surface ends at its last points.
   *
   * An axisymmetric surface has its mirror image beyond the axis r = 0, so that
   * it does not end there.
   *
   * Side 0 may consist of material points, which have no normal. Nearby points
   * of the surface face them, with the gap 0 and the opposite of their own
   * normal.
   */
  template <int dim>
  class SurfaceSearch
  {
  public:
    SurfaceSearch(const bool is_axisymmetric, const MPI_Comm comm)
      : is_axisymmetric(is_axisymmetric)
      , comm(comm)
    {}

    /// Collective. Set ContactPoint::is_facing, gap and target_normal of the
    /// points of both sides, on any processes, if the other side is within the
    /// distance @p reach, in units of the mean of their
    /// ContactPoint::cell_size. Points that may be in contact are sent to the
    /// process to which a box of space belongs; nothing is sent if the sides
    /// are further apart.
    void
    find_gaps(std::vector<ContactPoint<dim>> &points, const double reach) const;

  private:
    const bool     is_axisymmetric;
    const MPI_Comm comm;
  };
} // namespace greville

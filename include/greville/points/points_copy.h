// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/material_points.h>

namespace greville
{
  /**
   * A copy of the material points of one body on this process, in less than
   * half of their memory: it restores an earlier state for inspection, not for
   * an exact continuation.
   *
   * Mass, stress-free volume and id are stored exactly, the first two once for
   * consecutive points that share them. All other numbers have single
   * precision: the position relative to the centre of its cell (to 1e-7
   * of a cell), the initial position relative to the current one, J, its
   * projection and the diagonal of F less 1, others relative to their own size.
   * Lanes without a point are not stored.
   */
  template <int dim>
  class PointsCopy
  {
  public:
    void
    copy(const MaterialPoints<dim> &points);

    /// Overwrite @p points by the copy, with the layout of the copy. They must
    /// be the copied points or other points of the same space.
    void
    restore(MaterialPoints<dim> &points) const;

    /// Return the bytes on this process.
    std::size_t
    memory_consumption() const;

  private:
    /// Consecutive points with the same mass, stress-free volume and high_id.
    struct Run
    {
      double      mass, volume0, high_id; // id / 2^32, rounded down
      std::size_t n;
    };

    PointLayout<dim>           layout;
    std::vector<unsigned int>  cells, counts; // cells with points, their points
    std::vector<Run>           runs;
    std::vector<std::uint32_t> ids; // modulo 2^32
    std::vector<float>         rounded;
  };
} // namespace greville

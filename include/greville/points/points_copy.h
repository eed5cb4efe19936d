// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/material_points.h>

namespace greville
{
  /**
   * A copy of the material points of one body on this process in less than half
   * of their memory. It restores an earlier state for inspection; steps would
   * not continue exactly.
   *
   * Mass, stress-free volume and id are stored exactly; mass and volume are
   * stored once for consecutive points that share them. All other numbers are
   * stored in single precision after a subtraction: the centre of the cell from
   * the position (precise to 1e-7 of a cell), the current position from the
   * initial one, and 1 from J, its projection and the diagonal of F. Empty
   * lanes are not stored.
   */
  template <int dim>
  class PointsCopy
  {
  public:
    void
    copy(const MaterialPoints<dim> &points);

    /// Overwrite @p points by the copy, with the layout of the copy. @p points
    /// must have the space of the copied points.
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

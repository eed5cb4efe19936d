// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/material_points.h>

#include <filling.h>

// Random points in the filled cells, the same on any number of processes. Full
// cells have enough points to determine all their functions; cells that are
// less than half full have one point.
template <int dim>
MaterialPoints<dim>
random_points(const SplineSpace<dim> &space,
              const unsigned int      p,
              const Filling<dim>     &filling)
{
  MaterialPoints<dim> points;
  points.reinit(space, PointLayout<dim>());
  std::vector<double> numbers(points.layout().size, 0.);
  const PointRef<dim> point(numbers.data());
  point.J()        = 1.;
  const auto parts = fillings<dim>(space, filling);
  for (unsigned int c = 0; c < parts.size(); ++c)
    {
      const std::uint64_t cell  = space.owned_cells()[c];
      const CellBox<dim>  box   = space.box(c);
      const unsigned int  count = parts[c] <= 0.   ? 0
                                  : parts[c] < 0.5 ? 1
                                                   : Utilities::pow(p + 2, dim);
      for (unsigned int k = 0; k < count; ++k)
        {
          // A jittered lattice.
          unsigned int place = k;
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double t =
                count == 1
                  ? 0.5
                  : (place % (p + 2) + 0.5 +
                     0.4 * pseudo_random(dim * (1000 * cell + k) + d)) /
                      (p + 2);
              place /= p + 2;
              point.position(d) =
                space.lower_corner()[d] + box.size[d] * (box.index[d] + t);
            }
          point.volume0() = 1.;
          point.mass() =
            parts[c] * (1. + 0.5 * pseudo_random(1000 * cell + k)) / count;
          point.id() = 1000. * cell + k;
          points.insert(c, make_array_view(numbers));
        }
    }
  return points;
}

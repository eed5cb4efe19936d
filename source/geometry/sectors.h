// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_source_geometry_sectors_h
#define greville_source_geometry_sectors_h

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace greville
{
  namespace internal
  {
    /// Of planes through one point.
    constexpr unsigned int max_planes = 16;

    /// Unit vectors with a smaller product are at a right angle.
    constexpr double same_direction = 1e-9;



    /**
     * Call @p visit(direction) for a direction in each of the sectors into
     * which @p n lines through a point, with these unit normals, divide the
     * plane, until it returns true.
     */
    template <typename Visit>
    bool
    visit_sectors(const std::array<dealii::Tensor<1, 2>, max_planes> &normals,
                  const unsigned int                                  n,
                  const Visit                                        &visit)
    {
      std::array<double, 2 * max_planes + 1> angles;
      for (unsigned int i = 0; i < n; ++i)
        {
          const double angle = std::atan2(normals[i][0], -normals[i][1]);
          angles[2 * i]      = angle;
          angles[2 * i + 1] =
            angle + (angle > 0. ? -1. : 1.) * dealii::numbers::PI;
        }
      std::sort(angles.begin(), angles.begin() + 2 * n);
      angles[2 * n] = angles[0] + 2. * dealii::numbers::PI;
      for (unsigned int i = 0; i < 2 * n; ++i)
        if (angles[i + 1] - angles[i] > same_direction)
          {
            const double middle = 0.5 * (angles[i] + angles[i + 1]);
            if (visit(
                  dealii::Tensor<1, 2>({std::cos(middle), std::sin(middle)})))
              return true;
          }
      return false;
    }



    /**
     * The same for planes in space: each sector has an edge in which two planes
     * meet, unless all planes are parallel.
     */
    template <typename Visit>
    bool
    visit_sectors(const std::array<dealii::Tensor<1, 3>, max_planes> &normals,
                  const unsigned int                                  n,
                  const Visit                                        &visit)
    {
      bool are_parallel = true;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = i + 1; j < n; ++j)
          {
            auto         edge = cross_product_3d(normals[i], normals[j]);
            const double sine = edge.norm();
            if (sine < same_direction)
              continue;
            are_parallel = false;
            edge /= sine;
            // The planes around this edge, and the others.
            const auto across = cross_product_3d(edge, normals[i]);
            std::array<dealii::Tensor<1, 2>, max_planes> around;
            unsigned int                                 n_around = 0;
            double                                       margin   = 1.;
            for (unsigned int k = 0; k < n; ++k)
              if (std::abs(normals[k] * edge) < same_direction)
                around[n_around++] = dealii::Tensor<1, 2>(
                  {normals[k] * normals[i], normals[k] * across});
              else
                margin = std::min(margin, std::abs(normals[k] * edge));
            for (const int side : {-1, 1})
              if (visit_sectors(around,
                                n_around,
                                [&](const dealii::Tensor<1, 2> &direction) {
                                  return visit(dealii::Tensor<1, 3>(
                                    side * edge +
                                    0.5 * margin * direction[0] * normals[i] +
                                    0.5 * margin * direction[1] * across));
                                }))
                return true;
          }
      return are_parallel && (visit(normals[0]) || visit(-normals[0]));
    }
  } // namespace internal
} // namespace greville

#endif

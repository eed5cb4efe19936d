// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/numbers.h>
#include <deal.II/base/point.h>

#include <greville/contact/local_cells.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace greville::internal
{
  /// Return the sector of a normal: 60 degrees in 2D, around one of several
  /// axes in 3D. Common directions (multiples of 15 degrees, diagonals) are
  /// not on the border between two sectors.
  template <int dim>
  unsigned int
  sector_of(const dealii::Tensor<1, dim> &n)
  {
    if constexpr (dim == 2)
      {
        constexpr double shift = 0.187; // rad
        const double     turns =
          (std::atan2(n[1], n[0]) + shift) / (2. * dealii::numbers::PI);
        return unsigned(std::floor((turns - std::floor(turns)) * 6.)) % 6;
      }
    else
      {
        // Axes rotated by a rotation without symmetry.
        static const double axes[3][3] = {{0.9705, 0.1889, -0.1499},
                                          {-0.1639, 0.9727, 0.1644},
                                          {0.1769, -0.1350, 0.9749}};
        unsigned int        largest    = 0;
        double              values[3];
        for (unsigned int k = 0; k < 3; ++k)
          {
            values[k] =
              axes[k][0] * n[0] + axes[k][1] * n[1] + axes[k][2] * n[2];
            if (std::abs(values[k]) > std::abs(values[largest]))
              largest = k;
          }
        return 2 * largest + (values[largest] > 0.);
      }
  }



  /// The keys of a point with the values of their hat functions, which belong
  /// to the nodes of a lattice with a number.
  template <int dim>
  struct Hats
  {
    static constexpr unsigned int n = 1u << dim;

    std::array<std::uint64_t, n> keys;
    std::array<double, n>        values;

    Hats(const dealii::Point<dim>     &x,
         const dealii::Tensor<1, dim> &normal,
         const Lattice<dim>           &lattice,
         const unsigned int            number = 0)
    {
      constexpr std::int64_t zero = 1 << 19; // of 20 bits
      std::int64_t           cell[dim];
      double                 xi[dim];
      const auto             places = lattice.places(x);
      for (unsigned int d = 0; d < dim; ++d)
        {
          cell[d] = std::int64_t(std::floor(places[d]));
          xi[d]   = places[d] - double(cell[d]);
        }
      // At most three bits are needed for the sector.
      const std::uint64_t sector = sector_of<dim>(normal) | number << 3;
      for (unsigned int k = 0; k < n; ++k)
        {
          std::uint64_t key = sector;
          values[k]         = 1.;
          for (unsigned int d = 0; d < dim; ++d)
            {
              const unsigned int side = (k >> d) & 1;
              values[k] *= side ? xi[d] : 1. - xi[d];
              key = (key << 20) |
                    (std::uint64_t(cell[d] + side + zero) & ((1 << 20) - 1));
            }
          keys[k] = key;
        }
    }
  };
} // namespace greville::internal

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.templates.h>

#include <greville/contact/combine_by_key.h>
#include <greville/contact/overlap.h>

#include "hats.h"
#include <algorithm>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  template <int dim>
  Overlap<dim>
  largest_overlap(const std::vector<VolumePoint<dim>> &points,
                  const Tensor<1, dim>                &h,
                  const MPI_Comm                       comm)
  {
    double cell = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      cell *= h[d];
    // All points have the same normal, so that keys depend on nodes only.
    const Tensor<1, dim>   up = Point<dim>::unit_vector(dim - 1);
    const Lattice<dim>     lattice(Point<dim>(), h);
    std::vector<Hats<dim>> hats;
    hats.reserve(points.size());
    // The volume fractions of both sides, by node.
    std::unordered_map<std::uint64_t, std::array<double, 2>> fractions;
    for (const VolumePoint<dim> &point : points)
      {
        const Hats<dim> &own = hats.emplace_back(point.x, up, lattice);
        for (unsigned int k = 0; k < Hats<dim>::n; ++k)
          fractions[own.keys[k]][point.side] +=
            point.volume / cell * own.values[k];
      }
    combine_by_key(
      fractions,
      [](auto &sum, const auto &share) {
        for (unsigned int s = 0; s < 2; ++s)
          sum[s] += share[s];
      },
      comm);

    Overlap<dim> result;
    for (std::size_t p = 0; p < points.size(); ++p)
      {
        double sum = -1.;
        for (unsigned int k = 0; k < Hats<dim>::n; ++k)
          {
            const auto &of_node = fractions.at(hats[p].keys[k]);
            sum += hats[p].values[k] *
                   (std::min(1., of_node[0]) + std::min(1., of_node[1]));
          }
        if (sum > result.excess)
          result = {sum, points[p].x, points[p].side, points[p].body};
      }
    // If several processes have the largest overlap, take the point of the
    // first one.
    return Utilities::MPI::all_reduce<Overlap<dim>>(
      result, comm, [](const Overlap<dim> &a, const Overlap<dim> &b) {
        return b.excess > a.excess ? b : a;
      });
  }



  GREVILLE_INSTANTIATE(largest_overlap);
} // namespace greville

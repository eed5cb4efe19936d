// SPDX-License-Identifier: LGPL-2.1-or-later

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
    // The first process with the largest overlap sends it to all.
    const double       largest = Utilities::MPI::max(result.excess, comm);
    const unsigned int first =
      Utilities::MPI::min(result.excess == largest
                            ? Utilities::MPI::this_mpi_process(comm)
                            : Utilities::MPI::n_mpi_processes(comm),
                          comm);
    std::vector<double> row{result.excess,
                            double(result.side),
                            double(result.body)};
    for (unsigned int d = 0; d < dim; ++d)
      row.push_back(result.x[d]);
    row           = Utilities::MPI::broadcast(comm, row, first);
    result.excess = row[0];
    result.side   = row[1];
    result.body   = row[2];
    for (unsigned int d = 0; d < dim; ++d)
      result.x[d] = row[3 + d];
    return result;
  }



  template Overlap<2>
  largest_overlap(const std::vector<VolumePoint<2>> &,
                  const Tensor<1, 2> &,
                  const MPI_Comm);
  template Overlap<3>
  largest_overlap(const std::vector<VolumePoint<3>> &,
                  const Tensor<1, 3> &,
                  const MPI_Comm);
} // namespace greville

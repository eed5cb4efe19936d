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

  namespace
  {
    /// The hat functions at a point of the cells between edges.
    template <int dim>
    struct EdgeHats
    {
      static constexpr unsigned int n = Hats<dim>::n;

      std::array<std::uint64_t, n> keys;
      std::array<double, n>        values, integrals;

      EdgeHats(const Point<dim> &x, const CellEdges<dim> &all_edges)
      {
        values.fill(1.);
        integrals.fill(1.);
        keys.fill(0);
        for (unsigned int d = 0; d < dim; ++d)
          {
            const std::vector<double> &edges = all_edges[d];
            const unsigned int         cell =
              std::upper_bound(edges.begin() + 1, edges.end() - 1, x[d]) -
              edges.begin() - 1;
            const double h = edges[cell + 1] - edges[cell];
            const double xi =
              std::min(1., std::max(0., (x[d] - edges[cell]) / h));
            for (unsigned int k = 0; k < n; ++k)
              {
                const unsigned int side = (k >> d) & 1, node = cell + side;
                const double       before =
                  node > 0 ? edges[node] - edges[node - 1] : h;
                const double after =
                  node + 1 < edges.size() ? edges[node + 1] - edges[node] : h;
                values[k] *= side ? xi : 1. - xi;
                integrals[k] *= 0.5 * (before + after);
                keys[k] = (keys[k] << 20) | node;
              }
          }
      }
    };



    /// Collective. Find the largest overlap with the hat functions at the
    /// points; @p integral(hats, k) is that of one of them.
    template <int dim, typename HatsOfPoint, typename Integral>
    Overlap<dim>
    find_largest(const std::vector<VolumePoint<dim>> &points,
                 const std::vector<HatsOfPoint>      &hats,
                 const Integral                      &integral,
                 const MPI_Comm                       comm)
    {
      // The volume fractions of both sides, by node.
      std::unordered_map<std::uint64_t, std::array<double, 2>> fractions;
      for (std::size_t p = 0; p < points.size(); ++p)
        for (unsigned int k = 0; k < Hats<dim>::n; ++k)
          fractions[hats[p].keys[k]][points[p].side] +=
            points[p].volume / integral(hats[p], k) * hats[p].values[k];
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
  } // namespace



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
    for (const VolumePoint<dim> &point : points)
      hats.emplace_back(point.x, up, lattice);
    return find_largest<dim>(
      points,
      hats,
      [&](const auto &, const unsigned int) { return cell; },
      comm);
  }



  template <int dim>
  Overlap<dim>
  largest_overlap(const std::vector<VolumePoint<dim>> &points,
                  const CellEdges<dim>                &edges,
                  const MPI_Comm                       comm)
  {
    std::vector<EdgeHats<dim>> hats;
    hats.reserve(points.size());
    for (const VolumePoint<dim> &point : points)
      hats.emplace_back(point.x, edges);
    return find_largest<dim>(
      points,
      hats,
      [](const EdgeHats<dim> &at, const unsigned int k) {
        return at.integrals[k];
      },
      comm);
  }



  template Overlap<2>
  largest_overlap<2>(const std::vector<VolumePoint<2>> &,
                     const Tensor<1, 2> &,
                     const MPI_Comm);
  template Overlap<3>
  largest_overlap<3>(const std::vector<VolumePoint<3>> &,
                     const Tensor<1, 3> &,
                     const MPI_Comm);
  template Overlap<2>
  largest_overlap<2>(const std::vector<VolumePoint<2>> &,
                     const CellEdges<2> &,
                     const MPI_Comm);
  template Overlap<3>
  largest_overlap<3>(const std::vector<VolumePoint<3>> &,
                     const CellEdges<3> &,
                     const MPI_Comm);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>

#include <greville/base/errors.h>
#include <greville/mass/density_weights.h>

#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;

  template <int dim>
  DensityWeights<dim>::DensityWeights(const SplineSpace<dim> &space,
                                      const unsigned int      n_points_1d)
    : n_q(n_points_1d)
    , cell_begin(space.owned_cells().size())
    , cell_batches(CellBatches<dim>::make(space))
  {
    const unsigned int width = CellBatches<dim>::width();
    values.resize(cell_batches.size() * n_points() * width, 0.);
    for (std::size_t b = 0; b < cell_batches.size(); ++b)
      for (unsigned int lane = cell_batches[b].first_lane;
           lane < cell_batches[b].end_lane;
           ++lane)
        cell_begin[cell_batches[b].first_cell + lane] =
          b * n_points() * width + lane;
  }



  template <int dim>
  DensityWeights<dim>::DensityWeights(const SplineSpace<dim> &space,
                                      const unsigned int      n_points_1d,
                                      const Function<dim>    &density)
    : DensityWeights(space, n_points_1d)
  {
    const unsigned int width = CellBatches<dim>::width();

    const QGauss<dim>   quadrature(n_q);
    std::vector<double> densities(n_points());
    double              largest = 0.;
    std::string         message;

    const auto add_cells = [&](const auto &batch, const std::size_t b) {
      for (unsigned int lane = batch.first_lane; lane < batch.end_lane; ++lane)
        {
          const CellBox<dim> box         = space.box(batch.first_cell + lane);
          const auto         cell_points = points(box);
          density.value_list(cell_points, densities);
          for (unsigned int q = 0; q < n_points(); ++q)
            {
              if (!(densities[q] >= 0 && std::isfinite(densities[q])))
                {
                  std::ostringstream text;
                  text << "'Problem/Density' has to be a number >= 0, but is "
                       << densities[q] << " at (" << cell_points[q] << ").";
                  if (message.empty())
                    message = text.str();
                }
              largest = std::max(largest, densities[q]);
              values[(b * n_points() + q) * width + lane] =
                densities[q] * box.volume() * quadrature.weight(q);
            }
        }
    };
    run_on_all(space.communicator(), [&]() {
      for (std::size_t b = 0; b < cell_batches.size(); ++b)
        add_cells(cell_batches[b], b);
    });
    throw_on_all(message, space.communicator());
    Require(Utilities::MPI::max(largest, space.communicator()) > 0.,
            "'Problem/Density' is zero at all points: there is no mass.");
  }



  template <int dim>
  std::vector<Point<dim>>
  DensityWeights<dim>::points(const CellBox<dim> &box) const
  {
    const QGauss<1>         quadrature(n_q);
    std::vector<Point<dim>> result(n_points());
    MultiIndex<dim>         extents;
    extents.fill(n_q);
    for (unsigned int q = 0; q < n_points(); ++q)
      {
        const auto index = multi_index<dim>(q, extents);
        for (unsigned int d = 0; d < dim; ++d)
          result[q][d] =
            box.lower[d] + box.size[d] * quadrature.point(index[d])(0);
      }
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(DensityWeights);
} // namespace greville

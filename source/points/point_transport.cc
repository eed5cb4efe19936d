// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/points/point_transport.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  PointTransport<dim>::reinit(const SplineSpace<dim> &space)
  {
    spline_space = &space;
    comm         = space.communicator();
    owners_of_ghost_cells.clear();
    for (const auto &cell : space.triangulation().active_cell_iterators())
      if (cell->is_ghost())
        owners_of_ghost_cells[space.cell_position(cell->center())] =
          cell->subdomain_id();
  }



  template <int dim>
  std::vector<unsigned int>
  PointTransport<dim>::find_owners(
    const std::vector<std::uint64_t> &cells) const
  {
    std::vector<unsigned int> owners;
    for (const std::uint64_t cell : cells)
      {
        const auto found = owners_of_ghost_cells.find(cell);
        owners.push_back(found != owners_of_ghost_cells.end()
                           ? found->second
                           : spline_space->owner(cell));
      }
    return owners;
  }



  template <int dim>
  typename PointTransport<dim>::Result
  PointTransport<dim>::move(MaterialPoints<dim>             &points,
                            const std::vector<unsigned int> &left_cells)
  {
    Result result;
    leaving.clear();
    for (const unsigned int cell : left_cells)
      points.remove_leaving(cell, leaving);

    const unsigned int size      = points.layout().size;
    const Point<dim>  &lower     = spline_space->lower_corner();
    const Point<dim>  &upper     = spline_space->upper_corner();
    const std::size_t  n_leaving = leaving.size() / size;
    result.n_moved               = n_leaving;

    std::vector<double> foreign;
    for (std::size_t k = 0; k < n_leaving; ++k)
      {
        const PointRef<dim> p(leaving.data() + k * size);
        Point<dim>          x          = p.basis_position(points.layout());
        bool                is_outside = false;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double tolerance = 1e-9 * spline_space->cell_size(d);
            if (spline_space->is_periodic(d) &&
                (x[d] < lower[d] || x[d] > upper[d]))
              {
                const double period = upper[d] - lower[d];
                const double move =
                  period * std::floor((x[d] - lower[d]) / period);
                p.position(d) = x[d] = x[d] - move;
                p.reference(d) -= move;
              }
            is_outside = is_outside || !(x[d] >= lower[d] - tolerance &&
                                         x[d] <= upper[d] + tolerance);
            if (!is_outside)
              p[points.layout().basis_position + d] = x[d] =
                std::min(std::max(x[d], lower[d]), upper[d]);
          }
        if (is_outside)
          {
            ++result.n_removed;
            result.removed_mass += p.mass();
            // NaN takes precedence.
            if (std::isfinite(result.outside_position.norm()))
              {
                result.outside          = std::int64_t(p.id());
                result.outside_position = x;
              }
            continue;
          }
        const std::uint64_t position = spline_space->cell_position(x);
        const unsigned int  cell     = spline_space->find(position);
        if (cell != numbers::invalid_unsigned_int)
          points.insert(cell, ArrayView<const double>(&p[0], size));
        else
          {
            ++result.n_sent;
            foreign.push_back(double(position));
            foreign.insert(foreign.end(), &p[0], &p[0] + size);
          }
      }
    if (Utilities::MPI::n_mpi_processes(comm) > 1)
      insert(points, foreign);
    return result;
  }



  template <int dim>
  void
  PointTransport<dim>::insert(MaterialPoints<dim>       &points,
                              const std::vector<double> &rows)
  {
    const std::size_t          width = points.layout().size + 1;
    std::vector<std::uint64_t> places;
    for (std::size_t k = 0; k < rows.size(); k += width)
      places.push_back(std::uint64_t(rows[k]));
    const auto         owners  = find_owners(places);
    const unsigned int process = Utilities::MPI::this_mpi_process(comm);
    std::map<unsigned int, std::vector<double>> to_send;
    for (std::size_t k = 0; k < owners.size(); ++k)
      to_send[owners[k]].insert(to_send[owners[k]].end(),
                                rows.begin() + k * width,
                                rows.begin() + (k + 1) * width);
    auto own      = to_send.extract(process);
    auto received = exchange_lists(comm, to_send);
    if (!own.empty())
      received[process].swap(own.mapped());

    for (const auto &message : received)
      for (std::size_t k = 0; k < message.second.size(); k += width)
        {
          const unsigned int cell =
            spline_space->find(std::uint64_t(message.second[k]));
          Require(
            cell != numbers::invalid_unsigned_int,
            "A point has been sent to a process that does not own its cell.");
          points.insert(cell,
                        ArrayView<const double>(&message.second[k + 1],
                                                width - 1));
        }
  }



  GREVILLE_INSTANTIATE_CLASS(PointTransport);
} // namespace greville

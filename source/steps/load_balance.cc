// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/index_limits.h>
#include <greville/spline/cell_owner.h>
#include <greville/steps/load_balance.h>
#include <greville/steps/state_tables.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The weight of a point: p4est takes integers.
    constexpr double weight_of_point = 1000.;

    // The work of a cell without points, in units of the work of a point.
    constexpr double empty_cell = 0.1;



    unsigned int
    weight_of_cell(const double n_points)
    {
      constexpr double largest = 1e9;
      return std::min(
        largest,
        std::max(1., std::round(weight_of_point * (n_points + empty_cell))));
    }



    /// Move the points in the cells @p old_cells of this process to the
    /// processes that now own these cells.
    template <int dim>
    void
    move_with_cells(MaterialPoints<dim>              &points,
                    const std::vector<std::uint64_t> &old_cells,
                    Discretization<dim>              &discretization)
    {
      const SplineSpace<dim>   &space  = discretization.space();
      const PointLayout<dim>    layout = points.layout();
      const MaterialPoints<dim> old    = std::move(points);
      points                           = MaterialPoints<dim>();
      points.reinit(space, layout);
      std::vector<double> rows, point(layout.size);
      for (const unsigned int cell : old.cells())
        {
          const std::uint64_t position = old_cells[cell];
          const unsigned int  new_cell = space.find(position);
          for_each_as_inserted(old, cell, [&](const ConstPointRef<dim> p) {
            for (unsigned int i = 0; i < layout.size; ++i)
              point[i] = p[i];
            if (new_cell != numbers::invalid_unsigned_int)
              points.insert(new_cell, make_array_view(point));
            else
              {
                rows.push_back(double(position));
                rows.insert(rows.end(), point.begin(), point.end());
              }
          });
        }
      discretization.transport().insert(points, rows);
    }
  } // namespace



  template <int dim>
  double
  work_of_process(const State<dim> &state, const SplineSpace<dim> &space)
  {
    double work = empty_cell * space.owned_cells().size();
    for_all_points(state,
                   [&](const auto &points) { work += points.n_points(); });
    return work;
  }



  double
  imbalance(const double work, const MPI_Comm comm)
  {
    const auto all = Utilities::MPI::min_max_avg(work, comm);
    return all.avg > 0. ? all.max / all.avg : 1.;
  }



  template <int dim>
  Partition
  partition_by_points(const std::vector<std::uint64_t> &counts,
                      const SplineSpace<dim>           &space)
  {
    std::vector<double> rows;
    for (unsigned int cell = 0; cell < counts.size(); ++cell)
      if (counts[cell] > 0)
        {
          rows.push_back(double(space.owned_cells()[cell]));
          rows.push_back(weight_of_cell(double(counts[cell])));
        }
    return Partition(std::move(rows), space.communicator());
  }



  template <int dim>
  Partition
  balanced_partition(const State<dim> &state, const SplineSpace<dim> &space)
  {
    std::vector<std::uint64_t> counts(space.owned_cells().size(), 0);
    for_all_points(state, [&](const auto &points) {
      for (const unsigned int cell : points.cells())
        counts[cell] += points.n_points(cell);
    });
    return partition_by_points(counts, space);
  }



  template <int dim>
  void
  repartition_mesh(DistributedTriangulation<dim> &mesh,
                   const Partition               &partition)
  {
    const Lattice<dim> lattice(mesh);
    const MPI_Comm     comm        = get_communicator(mesh);
    const auto         position_of = [&](const auto &cell) {
      return lexicographic<dim>(lattice.find_cell(cell->center()),
                                lattice.n_cells());
    };
    std::unordered_map<std::uint64_t, unsigned int> weights;
    const unsigned int                              empty = weight_of_cell(0.);
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        weights[position_of(cell)] = empty;

    // A restart file may give this process rows of other processes' cells.
    std::map<unsigned int, std::vector<double>> to_send;
    for (std::size_t k = 0; k < partition.rows.size(); k += 2)
      {
        const auto   position = std::uint64_t(partition.rows[k]);
        const double weight   = partition.rows[k + 1];
        const auto   own      = weights.find(position);
        if (own != weights.end())
          own->second = weight;
        else
          {
            auto &rows = to_send[cell_owner<dim>(
              mesh, lattice, multi_index<dim>(position, lattice.n_cells()))];
            rows.insert(rows.end(), {partition.rows[k], weight});
          }
      }
    for (const auto &message : exchange_lists(comm, to_send))
      for (std::size_t k = 0; k < message.second.size(); k += 2)
        weights.at(std::uint64_t(message.second[k])) = message.second[k + 1];

    const auto connection =
      mesh.signals.weight.connect([&](const auto &cell, const auto) {
        return weights.at(position_of(cell));
      });
    mesh.repartition();
    connection.disconnect();
  }



  template <int dim>
  void
  redistribute(State<dim>                             &state,
               Discretization<dim>                    &discretization,
               const std::shared_ptr<const Partition> &partition)
  {
    const std::vector<std::uint64_t> old_cells =
      discretization.space().owned_cells();
    TablesFile fields;
    fields.tables = make_field_tables(state, discretization.space());
    discretization.repartition(partition);
    discretization.reinit();
    set_fields_from_tables(state, fields, discretization);
    for_all_points(state, [&](auto &points) {
      move_with_cells(points, old_cells, discretization);
    });
    state.partition = discretization.partition();
    state.points_have_changed();
  }



  GREVILLE_INSTANTIATE(work_of_process);
  GREVILLE_INSTANTIATE(partition_by_points);
  GREVILLE_INSTANTIATE(repartition_mesh);
  GREVILLE_INSTANTIATE(balanced_partition);
  GREVILLE_INSTANTIATE(redistribute);
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2 3
// All: 4

// Checks numbering and ownership on various meshes and partitions: each dof is
// owned once, all processes agree on its number, and the coefficients of the
// Greville points reproduce x on each cell.

#include <greville/base/index_limits.h>
#include <greville/spline/coarse_cells.h>

#include <map>
#include <tests.h>

template <int dim>
void
test(DistributedTriangulation<dim> &mesh, const unsigned int p)
{
  const SplineSpace<dim> space(mesh, p);
  const MPI_Comm         comm = MPI_COMM_WORLD;

  print() << dim << "D, p = " << p << ", cells " << mesh.n_global_active_cells()
          << ", dofs " << space.n_dofs() << std::endl;
  bool ok =
    Utilities::MPI::sum(space.n_locally_owned_dofs(), comm) == space.n_dofs();

  // Number = some function of the position, asked of the owner, has to be the
  // same on all cells and processes.
  const auto &positions = space.owned_functions();
  ok &= std::is_sorted(positions.begin(), positions.end());
  const auto numbers = space.global_numbers(positions);
  for (unsigned int k = 0; k < positions.size(); ++k)
    ok &= numbers[k] == space.locally_owned_dofs().nth_index_in_set(k);

  std::vector<types::global_dof_index> dofs;
  std::vector<std::uint64_t>           cell_positions;
  std::vector<types::global_dof_index> cell_numbers;
  double                               linear = 0;
  std::array<VectorType, dim>          x;
  for (VectorType &component : x)
    space.initialize_vector(component);
  for (unsigned int k = 0; k < positions.size(); ++k)
    {
      const auto index = multi_index<dim>(positions[k], space.n_functions());
      for (unsigned int c = 0; c < dim; ++c)
        x[c].local_element(k) = space.knots(c).greville_abscissa(index[c]);
    }
  for (VectorType &component : x)
    component.update_ghost_values();
  for (const auto &cell : mesh.active_cell_iterators())
    if (cell->is_locally_owned())
      {
        space.cell_dof_indices(cell, dofs);
        const auto      corner = space.lattice().find_cell(cell->center());
        MultiIndex<dim> local;
        local.fill(p + 1);
        for (unsigned int a = 0; a < dofs.size(); ++a)
          {
            auto function = multi_index<dim>(a, local);
            for (unsigned int d = 0; d < dim; ++d)
              function[d] += corner[d];
            cell_positions.push_back(
              lexicographic<dim>(function, space.n_functions()));
            cell_numbers.push_back(dofs[a]);
            ok &= space.partitioner()->in_local_range(dofs[a]) ||
                  space.partitioner()->is_ghost_entry(dofs[a]);
          }
        // At the cell's centre.
        for (unsigned int c = 0; c < dim; ++c)
          {
            std::array<std::vector<double>, dim> values;
            for (unsigned int d = 0; d < dim; ++d)
              {
                values[d].resize(p + 1);
                space.knots(d).evaluate(corner[d],
                                        cell->center()[d],
                                        0,
                                        make_array_view(values[d]));
              }
            double sum = -cell->center()[c];
            for (unsigned int a = 0; a < dofs.size(); ++a)
              {
                const auto index   = multi_index<dim>(a, local);
                double     product = x[c](dofs[a]);
                for (unsigned int d = 0; d < dim; ++d)
                  product *= values[d][index[d]];
                sum += product;
              }
            linear = std::max(linear, std::abs(sum));
          }
      }
  const auto asked = space.global_numbers(cell_positions);
  ok &= asked == cell_numbers;
  check("  numbers", Utilities::MPI::min(int(ok), comm) == 1);
  check("  reproduces x", max_all(linear), 1e-13);
}



template <int dim>
void
test_box(const MultiIndex<dim> &cells, const unsigned int p)
{
  Box<dim> box(cells);
  test<dim>(box.mesh, p);
}



template <int dim>
void
test_uneven(const MultiIndex<dim> &cells, const unsigned int p)
{
  Box<dim> box(cells, MPI_COMM_WORLD, {}, false);
  test<dim>(box.mesh, p);

  // Cells fill the grid between their edges, also those of twice the size.
  const bool has_parents = cells[0] % 2 == 0;
  for (const bool on_parents : {false, true})
    {
      if (on_parents && !has_parents)
        continue;
      const SplineSpace<dim> space(box.mesh, p, on_parents);
      const Lattice<dim>    &lattice = space.lattice();
      bool                   ok      = !space.is_uniform();
      double                 volume  = 0.;
      for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
        {
          const CellBox<dim> at = space.box(c);
          volume += at.volume();
          ok &= space.find(at.center) == c && space.contains(c, at.center) &&
                space.find(at.lower) == c && space.contains(c, at.lower);
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double upper = at.lower[d] + at.size[d];
              ok &=
                lattice.edge(d, at.index[d]) == at.lower[d] &&
                std::abs(lattice.edge(d, at.index[d] + 1) - upper) < 1e-14 &&
                std::abs(lattice.place(d, at.center[d]) - at.index[d] - 0.5) <
                  1e-12 &&
                lattice.smallest_near(d, at.index[d]) <= at.size[d] &&
                at.size[d] <= lattice.largest_cell_size(d);
            }
        }
      double whole = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        whole *= lattice.upper()[d] - lattice.lower()[d];
      check("  cells", Utilities::MPI::min(int(ok), MPI_COMM_WORLD) == 1);
      check("  volume",
            std::abs(Utilities::MPI::sum(volume, MPI_COMM_WORLD) / whole - 1.),
            1e-13);
    }
}



template <int dim>
unsigned int
weight(
  const typename parallel::distributed::Triangulation<dim>::cell_iterator &cell)
{
  // Nearly all of the weight in one corner.
  return cell->center().norm() < 0.4 ? 1000000 : 1;
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    {
      test_box<2>({{6, 5}}, p);
      test_box<2>({{8, 16}}, p);
      test_box<2>({{1, 1}}, p);
      test_box<2>({{3, 1}}, p);
    }
  for (unsigned int p = 1; p <= 4; ++p)
    test_box<3>({{4, 2, 6}}, p);

  print() << "cells of different sizes" << std::endl;
  for (unsigned int p = 1; p <= 5; ++p)
    test_uneven<2>({{8, 12}}, p);
  test_uneven<2>({{3, 7}}, 2);
  test_uneven<3>({{4, 8, 4}}, 3);

  print() << "weighted" << std::endl;
  Box<2> box(MultiIndex<2>{{16, 16}});
  box.mesh.signals.weight.connect(
    [weigh = &weight<2>](const auto &cell, const auto) { return weigh(cell); });
  box.mesh.repartition();
  for (unsigned int p = 1; p <= 5; ++p)
    test<2>(box.mesh, p);

  for (const unsigned int degree : {0, 6})
    try
      {
        SplineSpace<2>(box.mesh, degree);
        print() << "accepted" << std::endl;
      }
    catch (const std::exception &error)
      {
        print() << message_of(error) << std::endl;
      }
  // Coarse cells, which all processes keep.
  const std::string many =
    describe_many_coarse_cells<3>({{500, 500, 250}}, 10000);
  check("many coarse cells",
        many.find("<500, 500, 250>, which makes 7.8125e+06 coarse") !=
            std::string::npos &&
          many.find("<512, 512, 256> makes 4.") != std::string::npos);
  check("coarse cells fewer than those of a process",
        describe_many_coarse_cells<3>({{500, 500, 250}}, 1).empty());
  check("few coarse cells",
        describe_many_coarse_cells<3>({{512, 512, 256}}, 10000).empty());

  const auto is_refused = [](const auto &action) {
    try
      {
        action();
      }
    catch (const std::exception &error)
      {
        return message_of(error).find("2147483648 ") != std::string::npos;
      }
    return false;
  };
  const std::uint64_t most = std::numeric_limits<std::int32_t>::max();
  check("the last number of 32 bits",
        checked_index<std::int32_t>(most, "rows") == std::int32_t(most));
  check("more rows than a matrix can number",
        is_refused([&]() { checked_index<std::int32_t>(most + 1, "rows"); }));
  check("more rows for 64 bits",
        checked_index<std::int64_t>(most + 1, "rows") == 2147483648);
  check_message_size(most - 1024, false);
  check("a message that is too long",
        is_refused([&]() { check_message_size(most + 1, false); }));
  try
    {
      for (const auto &cell : box.mesh.active_cell_iterators())
        if (cell->is_locally_owned() && cell->center()[0] < 0.1)
          cell->set_refine_flag();
      box.mesh.execute_coarsening_and_refinement();
      SplineSpace<2>(box.mesh, 2);
      print() << "accepted" << std::endl;
    }
  catch (const std::exception &error)
    {
      print() << message_of(error) << std::endl;
    }
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 4

// Checks spaces on periodic grids: numbers, partition of unity, projections of
// order p + 1, matrices that commute with shifts, and hosts and extension that
// do not depend on where a period begins.

#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_cg.h>

#include <greville/mass/mass_operator.h>

#include <algorithm>
#include <filling.h>
#include <numeric>

template <int dim>
MultiIndex<dim>
shifted(MultiIndex<dim>              i,
        const MultiIndex<dim>       &extents,
        const std::array<bool, dim> &periodic,
        const unsigned int           shift)
{
  for (unsigned int d = 0; d < dim; ++d)
    if (periodic[d])
      i[d] = (i[d] + shift) % extents[d];
  return i;
}



// Each function is owned once, and all cells that see it agree on its number.
template <int dim>
void
test_numbers(const MultiIndex<dim>       &cells,
             const unsigned int           p,
             const std::array<bool, dim> &periodic)
{
  Box<dim>               box(cells, MPI_COMM_WORLD, periodic);
  const SplineSpace<dim> space(box.mesh, p);
  unsigned int           n = 1;
  for (unsigned int d = 0; d < dim; ++d)
    n *= periodic[d] ? cells[d] : cells[d] + p;
  print() << dim << "D, p = " << p << ": " << space.n_dofs() << " functions"
          << std::endl;
  check("number of functions", space.n_dofs() == n);
  check("owned once",
        Utilities::MPI::sum(space.n_locally_owned_dofs(), MPI_COMM_WORLD) == n);

  std::vector<std::uint64_t>           positions;
  std::vector<types::global_dof_index> numbers, dofs;
  MultiIndex<dim>                      local;
  local.fill(p + 1);
  for (const auto &cell : box.mesh.active_cell_iterators())
    if (cell->is_locally_owned())
      {
        space.cell_dof_indices(cell, dofs);
        const auto corner = space.lattice().find_cell(cell->center());
        for (unsigned int a = 0; a < dofs.size(); ++a)
          {
            auto function = multi_index<dim>(a, local);
            for (unsigned int d = 0; d < dim; ++d)
              function[d] = (function[d] + corner[d]) % space.n_functions()[d];
            positions.push_back(
              lexicographic<dim>(function, space.n_functions()));
            numbers.push_back(dofs[a]);
          }
      }
  check("numbers of cells",
        max_all(space.global_numbers(positions) != numbers),
        0.);

  // Partition of unity, at one place of each cell.
  double error = 0.;
  for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
    {
      const CellBox<dim>  box = space.box(c);
      std::vector<double> values(p + 1);
      double              product = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        {
          space.knots(d).evaluate(box.index[d],
                                  box.lower[d] + 0.3 * box.size[d],
                                  0,
                                  make_array_view(values));
          product *= std::accumulate(values.begin(), values.end(), 0.);
        }
      error = std::max(error, std::abs(product - 1.));
    }
  check("partition of unity", max_all(error), 1e-14);
}



template <int dim>
class Cosine : public Function<dim>
{
public:
  double
  value(const Point<dim> &x, const unsigned int) const override
  {
    return std::cos(2. * numbers::PI * x[0]);
  }
};



// The relative error of the projection of cos(2 pi x).
double
projection_error(const unsigned int n, const unsigned int p)
{
  Box<2>                     box({{n, 1}}, MPI_COMM_WORLD, {{true, false}});
  const SplineSpace<2>       space(box.mesh, p);
  const DensityWeights<2>    weights(space,
                                  2 * p + 1,
                                  Functions::ConstantFunction<2>(1.));
  const MassOperator<2>      mass(space, weights);
  const CrossMassOperator<2> cross(space, space, weights);
  VectorType                 x, b;
  space.initialize_vector(x);
  space.initialize_vector(b);
  cross.integrate(b, Cosine<2>());
  SolverControl        control(2000, 1e-14 * b.l2_norm());
  SolverCG<VectorType> solver(control);
  solver.solve(mass, x, b, PreconditionIdentity());
  const auto result = cross.difference(x, Cosine<2>());
  return result.first / result.second;
}



// The mass matrix times a shifted vector is the shifted product, and waves are
// its eigenvectors.
template <int dim>
void
test_circulant(const MultiIndex<dim>       &cells,
               const unsigned int           p,
               const std::array<bool, dim> &periodic)
{
  Box<dim>                  box(cells, MPI_COMM_WORLD, periodic);
  const SplineSpace<dim>    space(box.mesh, p);
  const DensityWeights<dim> weights(space,
                                    p + 1,
                                    Functions::ConstantFunction<dim>(1.));
  const MassOperator<dim>   mass(space, weights);
  const auto               &extents = space.n_functions();
  const auto vector = [&](const unsigned int shift, const bool wave) {
    VectorType x;
    space.initialize_vector(x);
    for (unsigned int f = 0; f < x.locally_owned_size(); ++f)
      {
        auto i =
          shifted<dim>(multi_index<dim>(space.owned_functions()[f], extents),
                       extents,
                       periodic,
                       shift);
        x.local_element(f) =
          wave ? std::cos(2. * numbers::PI * 2. * i[0] / extents[0])
               : pseudo_random(lexicographic<dim>(i, extents));
      }
    return x;
  };
  // All entries of both products, by position.
  std::vector<std::vector<double>> products;
  for (const unsigned int shift : {0u, 2u})
    {
      VectorType x = vector(shift, false), y(x);
      mass.vmult(y, x);
      products.emplace_back(space.n_dofs());
      for (unsigned int f = 0; f < x.locally_owned_size(); ++f)
        products.back()[lexicographic<dim>(
          shifted<dim>(multi_index<dim>(space.owned_functions()[f], extents),
                       extents,
                       periodic,
                       shift),
          extents)] = y.local_element(f);
      Utilities::MPI::sum(products.back(), MPI_COMM_WORLD, products.back());
    }
  double error = 0., size = 0.;
  for (unsigned int k = 0; k < products[0].size(); ++k)
    {
      error = std::max(error, std::abs(products[0][k] - products[1][k]));
      size  = std::max(size, std::abs(products[0][k]));
    }
  check("shifts commute with the mass", error, 1e-14 * size);
  if (std::count(periodic.begin(), periodic.end(), true) == dim)
    {
      VectorType x = vector(0, true), y(x);
      mass.vmult(y, x);
      const double eigenvalue = (x * y) / (x * x);
      check("eigenvalues of waves", eigenvalue > 0.);
      y.add(-eigenvalue, x);
      check("waves", y.linfty_norm(), 1e-14 * eigenvalue);
    }
}



// A drawing that is moved to the right by some columns has hosts and extension
// that are moved, too.
void
test_shifts(const std::vector<std::string> &rows, const unsigned int p)
{
  const MultiIndex<2> cells{
    {(unsigned int)rows[0].size(), (unsigned int)rows.size()}};
  const std::array<bool, 2>        periodic{{true, false}};
  std::vector<std::vector<double>> all;
  for (unsigned int shift = 0; shift < cells[0]; ++shift)
    {
      auto moved = rows;
      for (std::string &row : moved)
        std::rotate(row.begin(), row.end() - shift, row.end());
      Box<2>               box(cells, MPI_COMM_WORLD, periodic);
      const SplineSpace<2> space(box.mesh, p);
      CellFilling<2>       filling(space);
      filling.update(fillings<2>(space, drawing(moved)), 0.8);
      const Extension<2> extension(space, filling);
      const auto        &extents = space.n_functions();
      const auto         back    = [&](const std::uint64_t position) {
        return shifted<2>(multi_index<2>(position, extents),
                          extents,
                          periodic,
                          cells[0] - shift);
      };

      // A linear function of positions and weights, for each owned function.
      std::vector<double>        result(space.n_dofs(), 0.), weights;
      std::vector<std::uint64_t> positions;
      for (unsigned int f = 0; f < space.owned_functions().size(); ++f)
        {
          double value = extension[f];
          if (extension[f] == Extension<2>::extended)
            {
              extension.row(f, positions, weights);
              for (unsigned int k = 0; k < positions.size(); ++k)
                value +=
                  weights[k] *
                  pseudo_random(lexicographic<2>(back(positions[k]), extents));
            }
          result[lexicographic<2>(back(space.owned_functions()[f]), extents)] =
            value;
        }
      Utilities::MPI::sum(result, MPI_COMM_WORLD, result);
      all.push_back(result);
      const auto counts = extension.counts();
      if (shift == 0)
        print() << "p = " << p << ": " << counts.stable << " stable, "
                << counts.extended << " extended, " << counts.lumped
                << " lumped" << std::endl;
    }
  double error = 0.;
  for (const auto &result : all)
    for (unsigned int k = 0; k < result.size(); ++k)
      error = std::max(error, std::abs(result[k] - all[0][k]));
  check("hosts and extension move with the body", error, 1e-11);
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    {
      test_numbers<2>({{p + 1, 5}}, p, {{true, false}});
      test_numbers<2>({{8, 16}}, p, {{true, true}});
      test_numbers<2>({{7, 2}}, p, {{true, false}});
      test_circulant<2>({{12, 6}}, p, {{true, true}});
      test_circulant<2>({{9, 16}}, p, {{false, true}});
    }
  for (unsigned int p = 1; p <= 3; ++p)
    {
      test_numbers<3>({{4, 2, 6}}, p, {{true, false, true}});
      test_circulant<3>({{4, 4, 8}}, p, {{true, true, true}});
    }
  for (unsigned int p = 1; p <= 5; ++p)
    {
      const double coarse = projection_error(16, p);
      const double order  = std::log2(coarse / projection_error(32, p));
      print() << "projection, p = " << p << ": " << std::setprecision(3)
              << 1e6 * coarse << "e-6" << std::endl;
      check("order p + 1", std::abs(order - (p + 1.)), 0.15);
    }
  for (unsigned int p = 1; p <= 4; ++p)
    test_shifts({"....++........",
                 "...+###+......",
                 "..+######+..+.",
                 "..########....",
                 "..+######+....",
                 "....####+...++",
                 "....+++......."},
                p);

  try
    {
      test_numbers<2>({{3, 4}}, 3, {{true, false}});
    }
  catch (const ExceptionBase &exception)
    {
      print() << "three cells: "
              << (std::string(exception.what()).find("order + 1 = 4") !=
                      std::string::npos
                    ? "refused"
                    : "wrong message")
              << std::endl;
    }
}

// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks that the mass operator with weights of material points at 2 p + 1
// Gauss points per direction equals the sum over the points.

#include <greville/paper/assembled_mass_level.h>
#include <greville/points/point_transfer.h>

#include "points.h"

// The largest difference of two vectors, relative to the second.
double
max_difference(const VectorType &a, const VectorType &b)
{
  VectorType d(a);
  d -= b;
  return d.linfty_norm() / b.linfty_norm();
}



template <int dim>
void
test(const MultiIndex<dim> &cells, const unsigned int p, const bool part)
{
  Box<dim>               box(cells);
  const SplineSpace<dim> space(box.mesh, p);
  print() << dim << "D, p = " << p << (part ? ", a part of the cells" : "")
          << std::endl;
  MaterialPoints<dim> a, b;
  random_points<dim>(
    a, space, make_layout<dim>(0, false, false), cube<dim>(3), 0.9, 1, 0.3);
  random_points<dim>(
    b, space, make_layout<dim>(1, true, true), cube<dim>(2), 0.9, 2, 0.5);
  if (part)
    // Only the lower half keeps points.
    for (MaterialPoints<dim> *points : {&a, &b})
      {
        MaterialPoints<dim> some;
        some.reinit(space, points->layout());
        points->for_each([&](const unsigned int cell, const auto q) {
          if (space.box(cell).index[1] < cells[1] / 2)
            some.insert(cell, make_array_view(numbers_of<dim>(*points, q)));
        });
        *points = some;
      }
  // Polynomials of degree 2 p lose some digits.
  const double       bound = p <= 3 ? 1e-13 : 1e-12;
  PointTransfer<dim> transfer;
  transfer.reinit(space);
  DensityWeights<dim> weights(space, 2 * p + 1);
  // Earlier values are overwritten.
  transfer.mass_weights({&a, &a}, weights);
  transfer.mass_weights({&a, &b}, weights);

  // Direct sums: lumped mass, diagonal, and the product with a vector x.
  DirectSums<dim> sums(space, 3);
  double          total = 0.;
  for (const MaterialPoints<dim> *points : {&a, &b})
    points->for_each([&](const unsigned int, const auto q) {
      const double     m = q.mass();
      const Point<dim> x = q.position();
      double           u = 0.;
      total += m;
      for_each_function<dim>(space,
                             x,
                             [&](const std::uint64_t f,
                                 const Point<dim> &,
                                 const double N,
                                 const Tensor<1, dim> &) {
                               u += N * pseudo_random(f);
                             });
      for_each_function<dim>(space,
                             x,
                             [&](const std::uint64_t f,
                                 const Point<dim> &,
                                 const double N,
                                 const Tensor<1, dim> &) {
                               sums(f, 0) += m * N;
                               sums(f, 1) += m * N * N;
                               sums(f, 2) += m * N * u;
                             });
    });
  sums.add_processes();
  total                   = Utilities::MPI::sum(total, MPI_COMM_WORLD);
  double largest_diagonal = 0.;
  for (std::size_t f = 0; f < space.n_dofs(); ++f)
    largest_diagonal = std::max(largest_diagonal, sums(f, 1));

  const VectorType        x = pseudo_random_vector(space);
  AssembledMassLevel<dim> level(space, weights);
  level.assemble(true, true);
  const MassOperator<dim> &mass = level.mass();

  // Inactive is what meets no mass (as far as double precision can tell).
  std::vector<bool> inactive(space.owned_functions().size(), false);
  for (const unsigned int i : mass.inactive())
    inactive[i] = true;
  bool       right_ones = true;
  VectorType lumped(x), diagonal(x), product(x);
  for (unsigned int i = 0; i < inactive.size(); ++i)
    {
      const std::uint64_t f = space.owned_functions()[i];
      if (sums(f, 1) == 0.)
        right_ones &= inactive[i];
      else if (inactive[i])
        right_ones &= sums(f, 1) <= 1e-14 * largest_diagonal;
      lumped.local_element(i)   = inactive[i] ? largest_diagonal : sums(f, 0);
      diagonal.local_element(i) = inactive[i] ? largest_diagonal : sums(f, 1);
      product.local_element(i) =
        inactive[i] ? largest_diagonal * x.local_element(i) : sums(f, 2);
    }
  VectorType y(x), z(x);
  mass.vmult(y, x);
  check("  product", max_difference(y, product), bound);
  check("  lumped mass", max_difference(level.lumped(), lumped), bound);
  check("  diagonal", max_difference(mass.diagonal(), diagonal), bound);
  check("  inactive coefficients", on_all(right_ones));
  // The largest entries of inactive coefficients would hide what is small: the
  // mass.
  VectorType sums_of_rows(x);
  mass.cross_mass().row_sums(sums_of_rows);
  double sum = 0.;
  for (unsigned int i = 0; i < sums_of_rows.locally_owned_size(); ++i)
    sum += sums_of_rows.local_element(i);
  sum = Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  check("  total mass", std::abs(sum / total - 1.), bound);
  print() << "  inactive: "
          << Utilities::MPI::sum(mass.inactive().size(), MPI_COMM_WORLD)
          << " of " << space.n_dofs() << std::endl;
  level.vmult(z, x);
  check("  assembled", max_difference(z, product), bound);
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    {
      test<2>({{6, 5}}, p, false);
      test<2>({{5, 8}}, p, true);
    }
  for (unsigned int p = 1; p <= 3; ++p)
    test<3>({{3, 4, 2}}, p, p == 2);
}

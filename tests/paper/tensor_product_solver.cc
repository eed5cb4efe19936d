// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2 3

// Checks that the tensor-product inverse is exact for constant density on any
// number of processes. For other densities, its preconditioner is symmetric and
// leaves inactive coefficients unchanged.

#include <greville/mass/mass_operator.h>
#include <greville/paper/tensor_product_solver.h>

#include <density.h>

template <int dim>
void
test(const MultiIndex<dim> &cells, const unsigned int p)
{
  Box<dim>                       box(cells);
  const SplineSpace<dim>         space(box.mesh, p);
  const TensorProductSolver<dim> solver(space);
  const std::string name = std::to_string(dim) + "D, p = " + std::to_string(p);

  {
    const DensityWeights<dim>              weights(space,
                                      p + 1,
                                      Functions::ConstantFunction<dim>(3.));
    const MassOperator<dim>                mass(space, weights);
    const TensorProductPreconditioner<dim> inverse(solver,
                                                   mass.diagonal(),
                                                   mass.inactive());
    const VectorType                       x = pseudo_random_vector(space);
    VectorType                             y(x), z(x);
    mass.vmult(y, x);
    inverse.vmult(z, y);
    check(name + ", inverse", difference(z, x), 1e-9);
    double diagonal = 0;
    for (unsigned int i = 0; i < space.n_locally_owned_dofs(); ++i)
      diagonal = std::max(diagonal,
                          std::abs(3. * solver.diagonal(i) /
                                     mass.diagonal().local_element(i) -
                                   1.));
    check(name + ", diagonal", max_all(diagonal), 1e-12);
  }
  {
    const auto                             rho = density<dim>("holes");
    const DensityWeights<dim>              weights(space, p + 1, *rho);
    const MassOperator<dim>                mass(space, weights);
    const TensorProductPreconditioner<dim> inverse(solver,
                                                   mass.diagonal(),
                                                   mass.inactive());
    VectorType                             x = pseudo_random_vector(space);
    VectorType                             y(x), Sx(x), Sy(x);
    for (unsigned int i = 0; i < y.locally_owned_size(); ++i)
      y.local_element(i) = std::cos(5. * x.local_element(i));
    inverse.vmult(Sx, x);
    inverse.vmult(Sy, y);
    check(name + ", symmetry",
          std::abs(Sx * y - x * Sy) / (Sx.l2_norm() * y.l2_norm()),
          1e-12);
    double inactive = 0;
    for (const unsigned int i : mass.inactive())
      inactive = std::max(inactive,
                          std::abs(Sx.local_element(i) *
                                     mass.diagonal().local_element(i) -
                                   x.local_element(i)));
    check(name + ", inactive coefficients", max_all(inactive), 1e-14);
  }
  const bool alone = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1;
  const auto sent =
    Utilities::MPI::sum((unsigned long)(solver.bytes_sent()), MPI_COMM_WORLD);
  check(name + ", communication",
        alone ? sent == 0 : sent > 0 && sent <= 8 * (dim + 1) * space.n_dofs());
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    {
      test<2>({{16, 12}}, p);
      test<3>({{6, 4, 8}}, p);
    }
}

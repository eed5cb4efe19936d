// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2 3

// Checks geometric levels below the Laplacian of order 1 on bodies that end
// anywhere in the lattice: the conjugate gradient iterations do not grow with
// the mesh and do not depend on the number of processes.

#include <deal.II/lac/solver_cg.h>

#include <greville/benchmark/laplace_level.h>
#include <greville/multigrid/lattice_cycle.h>

#include <tests.h>

// Iterations until the residual has fallen by 1e-8. The functions outside of a
// ball are constrained to zero.
template <int dim>
unsigned int
iterations(const unsigned int           n_cells,
           const std::array<bool, dim> &periodic = {})
{
  Box<dim>               box(cube<dim>(n_cells), MPI_COMM_WORLD, periodic);
  const SplineSpace<dim> space(box.mesh, 1);
  Point<dim>             center;
  for (unsigned int d = 0; d < dim; ++d)
    center[d] = 0.47 + 0.2 * d;
  std::vector<unsigned char> constrained(space.owned_functions().size() +
                                         space.ghost_functions().size());
  for (unsigned int i = 0; i < constrained.size(); ++i)
    constrained[i] = space.greville_point(i).distance(center) > 0.43;
  const LaplaceLevel<dim> laplace(space, constrained);
  const auto              preconditioner = laplace.lattice_preconditioner({});

  VectorType x, b = pseudo_random_vector(space);
  for (const unsigned int i : laplace.inactive())
    b.local_element(i) = 0.;
  space.initialize_vector(x);
  SolverControl control(100, 1e-8 * b.l2_norm());
  SolverCG<VectorType>(control).solve(laplace, x, b, *preconditioner);
  VectorType residual(b), product(b);
  laplace.vmult(product, x);
  residual -= product;
  check("solved", residual.l2_norm(), 2e-8 * b.l2_norm());
  return control.last_step();
}



void
test_main()
{
  check_range("2D, few rows", iterations<2>(8), 1, 9);
  check_range("3D, few rows", iterations<3>(6), 1, 9);
  for (const unsigned int n : {32, 64, 128})
    check_range("2D, " + std::to_string(n), iterations<2>(n), 3, 9);
  for (const unsigned int n : {12, 24})
    check_range("3D, " + std::to_string(n), iterations<3>(n), 3, 9);
  check_range("2D, periodic", iterations<2>(32, {{true, false}}), 3, 12);
}

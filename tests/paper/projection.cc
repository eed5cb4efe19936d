// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2
// Debug: no

// Checks the L2 projection of a smooth function: order p + 1 for values and p
// for gradients in 2D and 3D. It uses every component of a solve (extraction,
// operator, tensor-product inverse, deal.II's integration of errors).

#include <deal.II/base/function_lib.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/numerics/vector_tools.h>

#include <greville/mass/mass_operator.h>
#include <greville/paper/tensor_product_solver.h>

#include <tests.h>

template <int dim>
std::pair<double, double>
errors(const unsigned int p, const unsigned int n)
{
  Box<dim>                             box(cube<dim>(n));
  const SplineSpace<dim>               space(box.mesh, p);
  const DensityWeights<dim>            weights(space,
                                    p + 1,
                                    Functions::ConstantFunction<dim>(1.));
  const MassOperator<dim>              mass(space, weights);
  const Functions::CosineFunction<dim> f;

  VectorType x;
  space.initialize_vector(x);
  mass.cross_mass().integrate(x, f);
  TensorProductSolver<dim>(space).solve(x);

  DoFHandler<dim> dof_handler(box.mesh);
  dof_handler.distribute_dofs(space.fe());
  const IndexSet relevant =
    DoFTools::extract_locally_relevant_dofs(dof_handler);
  VectorType field(dof_handler.locally_owned_dofs(), relevant, MPI_COMM_WORLD);
  space.extract(x, dof_handler, field);
  Vector<double>    cell_errors(box.mesh.n_active_cells());
  const QGauss<dim> quadrature(p + 3);
  double            norms[2];
  for (const auto norm : {VectorTools::L2_norm, VectorTools::H1_seminorm})
    {
      VectorTools::integrate_difference(
        dof_handler, field, f, cell_errors, quadrature, norm);
      norms[norm == VectorTools::H1_seminorm] =
        VectorTools::compute_global_error(box.mesh, cell_errors, norm);
    }
  return {norms[0], norms[1]};
}



template <int dim>
void
test(const unsigned int p, const unsigned int n)
{
  const auto        coarse = errors<dim>(p, n), fine = errors<dim>(p, 2 * n);
  const double      values    = std::log2(coarse.first / fine.first);
  const double      gradients = std::log2(coarse.second / fine.second);
  const std::string name = std::to_string(dim) + "D, p = " + std::to_string(p);
  check(name + ", order p + 1 of values", p + 1 - values, 0.3);
  check(name + ", order p of gradients", p - gradients, 0.3);
  check(name + ", not above", std::max(values - p - 1, gradients - p), 0.7);
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    test<2>(p, 16);
  for (unsigned int p = 1; p <= 5; ++p)
    test<3>(p, p < 5 ? 8 : 6);
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// All: 1 2
// Debug: no

// Checks Table 1 of Tielen, Moeller and Vuik (2019) for V-, W- and F-cycles: no
// entry needs more iterations than published on one process, and at most two
// more on several. The bound in 3D is 3.

#include <deal.II/base/function_lib.h>

#include <greville/paper/mass_solver.h>
#include <greville/paper/paper_parts.h>

#include <tests.h>

template <int dim>
unsigned int
count(const unsigned int n, const unsigned int p, const std::string &cycle)
{
  Box<dim>                  box(cube<dim>(n));
  const OrderHierarchy<dim> orders(box.mesh, p);
  MassHierarchy<dim>        mass(orders, Functions::ConstantFunction<dim>(1.));
  MassSolverParameters      solver_parameters;
  PaperMultigridParameters  multigrid;
  SmootherParameters        smoother;
  multigrid.cycle = value_of(cycle, cycle_types);
  MassSolver<dim> solver(
    "p-multigrid", mass, solver_parameters, multigrid, smoother);
  solver.assemble();
  solver.setup();
  VectorType x, b;
  orders.finest().initialize_vector(x);
  orders.finest().initialize_vector(b);
  mass.finest().mass().cross_mass().integrate(
    b, Functions::ConstantFunction<dim>(-9.81));
  const SolveResult result = solver.solve(x, b);
  return result.converged ? *result.iterations : 1000;
}



void
test_main()
{
  add_paper_parts();
  const unsigned int more =
    Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1 ? 0 : 2;
  const unsigned int published[4][5] = {{1, 3, 3, 2, 2},
                                        {1, 3, 3, 3, 3},
                                        {1, 3, 3, 3, 3},
                                        {1, 3, 3, 3, 2}};
  for (const std::string cycle : {"V", "W", "F"})
    for (unsigned int row = 0; row < (cycle == "V" ? 4 : 2); ++row)
      for (unsigned int p = 1; p <= 5; ++p)
        check_range(cycle + ", " + std::to_string(16 << row) +
                      " cells, p = " + std::to_string(p),
                    count<2>(16 << row, p, cycle),
                    1,
                    published[row][p - 1] + more);
  for (unsigned int n : {8, 16})
    for (unsigned int p = 1; p <= 4; ++p)
      check_range("3D, " + std::to_string(n) +
                    " cells, p = " + std::to_string(p),
                  count<3>(n, p, "V"),
                  1,
                  3 + more);
}

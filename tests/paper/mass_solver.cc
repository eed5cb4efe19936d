// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3 4

// Checks every solver by name on constant, smooth and half-empty densities in
// 2D and 3D: the iterations are in range, or the solver reports why it did not
// converge. FMPM(K) equals its series, and results do not depend on the number
// of processes.

#include <greville/paper/mass_solver.h>
#include <greville/paper/paper_parts.h>

#include <density.h>

template <int dim>
struct Problem
{
  Problem(const MultiIndex<dim> &cells,
          const unsigned int     p,
          const std::string     &rho,
          const MPI_Comm         comm = MPI_COMM_WORLD)
    : box(cells, comm)
    , orders(box.mesh, p)
    , mass(orders, *density<dim>(rho))
  {}

  SolveResult
  run(const std::string &name, VectorType &x)
  {
    MassSolver<dim> solver(name, mass, solver_parameters, multigrid, smoother);
    solver.assemble();
    solver.setup();
    VectorType b;
    orders.finest().initialize_vector(x);
    orders.finest().initialize_vector(b);
    mass.finest().mass().cross_mass().integrate(
      b, *make_function<dim>("sin(3*x)*cos(2*y)", "f"));
    return solver.solve(x, b);
  }

  Box<dim>                 box;
  OrderHierarchy<dim>      orders;
  MassHierarchy<dim>       mass;
  MassSolverParameters     solver_parameters;
  PaperMultigridParameters multigrid;
  SmootherParameters       smoother;
};



template <int dim>
void
test(const MultiIndex<dim> &cells, const unsigned int p, const std::string &rho)
{
  Problem<dim> problem(cells, p, rho);
  problem.multigrid.smoother = "ic0";
  VectorType reference, x;
  problem.solver_parameters.tolerance = 1e-12;
  problem.run("cg-jacobi", reference);
  problem.solver_parameters.tolerance = 1e-8;

  print() << dim << "D, p = " << p << ", " << rho << std::endl;
  for (const std::string name :
       {"p-multigrid", "cg-p-multigrid", "fgmres-p-multigrid"})
    {
      problem.multigrid.restriction =
        name == "cg-p-multigrid" ? "transpose" : "lumped-l2";
      const SolveResult result = problem.run(name, x);
      check("  " + name + " converges", result.converged);
      check_range("  iterations", *result.iterations, 1, 12);
      check("  solution", difference(x, reference), 1e-4);
    }
  problem.multigrid.smoother    = "ict";
  problem.multigrid.restriction = "transpose";
  for (const std::string name : {"cg-p-multigrid", "cg-smoother"})
    {
      const SolveResult result = problem.run(name, x);
      check("  " + name + " with ICT converges", result.converged);
      check_range("  iterations", *result.iterations, 1, 12);
      check("  solution", difference(x, reference), 1e-4);
    }
  for (const std::string name : {"cg", "cg-jacobi", "cg-tensor-product"})
    {
      const SolveResult result = problem.run(name, x);
      check("  " + name + " converges", result.converged);
      check_range("  iterations",
                  *result.iterations,
                  name == "cg-tensor-product" ? 1 : 10,
                  name == "cg-tensor-product" ? 60 : 900);
    }
  double last = 1.;
  for (const std::string name : {"lumped", "fmpm-2", "fmpm-4", "fmpm-8"})
    {
      const SolveResult result = problem.run(name, x);
      check("  " + name + " has no iterations", !result.iterations);
      check("  and says why it is not converged",
            !result.converged && !result.reason.empty());
      check("  but is better than less", result.reduction < last);
      last = result.reduction;
    }
  const SolveResult result = problem.run("tensor-product", x);
  check("  tensor-product is exact for constant density",
        result.converged == (rho == "constant"));
}



void
test_main()
{
  add_paper_parts();
  for (const std::string rho : {"constant", "smooth", "holes"})
    {
      test<2>({{16, 12}}, 3, rho);
      test<3>({{6, 6, 8}}, 2, rho);
    }

  // The same on one process and on all: with a smoother that does not know of
  // processes, to 1e-12.
  {
    Problem<2> all({{16, 16}}, 3, "smooth");
    Problem<2> alone({{16, 16}}, 3, "smooth", MPI_COMM_SELF);
    double     error = 0;
    for (auto *problem : {&all, &alone})
      {
        problem->solver_parameters.tolerance = 1e-14;
        problem->multigrid.smoother          = "tensor-product";
      }
    VectorType x, y;
    all.run("p-multigrid", x);
    alone.run("p-multigrid", y);
    const auto &positions = all.orders.finest().owned_functions();
    for (unsigned int i = 0; i < positions.size(); ++i)
      error =
        std::max(error,
                 std::abs(x.local_element(i) - y.local_element(positions[i])));
    check("same on all numbers of processes",
          max_all(error) / y.linfty_norm(),
          1e-12);
  }

  // Options of the solver.
  {
    Problem<2>        problem({{8, 8}}, 3, "smooth");
    VectorType        x, y;
    const SolveResult tight             = problem.run("cg", x);
    problem.solver_parameters.tolerance = 1e-3;
    const SolveResult loose             = problem.run("cg", x);
    check("tolerance has an effect", *loose.iterations < *tight.iterations);
    problem.solver_parameters.max_iterations = 2;
    const SolveResult failed                 = problem.run("cg", x);
    check("maximum of iterations has an effect", !failed.converged);
    print() << failed.reason.substr(0, 22) << std::endl;

    problem.solver_parameters.tolerance      = 1e-10;
    problem.solver_parameters.max_iterations = 1000;
    problem.solver_parameters.operator_kind  = "assembled";
    MassSolver<2> assembled("lumped",
                            problem.mass,
                            problem.solver_parameters,
                            problem.multigrid,
                            problem.smoother);
    assembled.assemble();
    check("operator has an effect",
          problem.mass.finest().assembled() != nullptr);
    problem.solver_parameters.operator_kind = "matrix-free";
    assembled.assemble();
    check("no matrix is left", problem.mass.finest().assembled() == nullptr);
  }

  for (const std::string name : {"amg", "fmpm-", "fmpm-0", "fmpm-2x"})
    try
      {
        MassSolver<2>::check_name(name, "Solvers");
        print() << "accepted" << std::endl;
      }
    catch (const std::exception &error)
      {
        print() << message_of(error).substr(0, 40) << std::endl;
      }
}

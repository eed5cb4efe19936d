// SPDX-License-Identifier: LGPL-2.1-or-later

// Compares the project's solver of the exact mass matrix with PETSc's on the
// same matrix: CPU time of IC(0) and of conjugate gradients for two vector
// fields (velocity and acceleration of a step). ExtendedMassSolver solves all
// columns together, on stencils and extended functions; KSPCG with PCICC solves
// column by column, on the assembled matrix. The points come from a simulation
// after STEPS (0).
//
//   ninja -C build solver_benchmark
//   build/solver_benchmark FILE.prm [STEPS [ROUNDS]]
//
// prints a table in Markdown: medians over ROUNDS (9), in which the methods
// take turns. One process.

#include <deal.II/base/mpi.h>

#include <greville/base/petsc.h>
#include <greville/multigrid/extended_mass_solver.h>
#include <greville/steps/simulation.h>

#include <petscksp.h>

#include "timing.h"
#include <cstdio>
#include <functional>
#include <random>

using namespace dealii;
using namespace greville;

namespace
{
  using PetscSolver = PetscHandle<KSP, KSPDestroy>;

  double
  cpu_milliseconds(const std::function<void()> &work)
  {
    const double start = cpu_seconds();
    work();
    return 1e3 * (cpu_seconds() - start);
  }



  // MATSEQAIJ with all entries, or MATSEQSBAIJ with the upper triangle.
  PetscMatrix
  petsc_matrix(const UpperTriangle &entries, const bool symmetric)
  {
    const PetscInt        n = entries.size();
    std::vector<PetscInt> counts(n, 0);
    for (PetscInt i = 0; i < n; ++i)
      for (std::size_t e = entries.row_begin[i]; e < entries.row_begin[i + 1];
           ++e)
        {
          const PetscInt j = entries.columns[e];
          ++counts[i];
          if (j != i && !symmetric)
            ++counts[j];
        }
    Mat matrix;
    if (symmetric)
      check_petsc(
        MatCreateSeqSBAIJ(PETSC_COMM_SELF, 1, n, n, 0, counts.data(), &matrix));
    else
      check_petsc(
        MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, counts.data(), &matrix));
    PetscMatrix result(matrix);
    for (PetscInt i = 0; i < n; ++i)
      for (std::size_t e = entries.row_begin[i]; e < entries.row_begin[i + 1];
           ++e)
        {
          const PetscInt j = entries.columns[e];
          check_petsc(
            MatSetValue(matrix, i, j, entries.values[e], INSERT_VALUES));
          if (j != i && !symmetric)
            check_petsc(
              MatSetValue(matrix, j, i, entries.values[e], INSERT_VALUES));
        }
    check_petsc(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
    check_petsc(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
    check_petsc(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
    return result;
  }



  // Times of a method, ms.
  struct Method
  {
    std::string           name;
    std::function<void()> factorize;
    std::function<int()>  solve; // returns the iterations of the worst column
    std::vector<double>   factorizations, solves;
    int                   iterations = 0;
  };



  template <int dim>
  void
  measure(const SimulationParameters &parameters,
          const unsigned int          n_steps,
          const unsigned int          n_rounds)
  {
    constexpr unsigned int n_fields = 2, n_columns = n_fields * dim;
    constexpr unsigned int width      = dim == 2 ? 4 : 8;
    SimulationParameters   consistent = parameters;
    consistent.scheme.mass            = "consistent";
    Simulation<dim>         simulation(consistent, MPI_COMM_WORLD);
    const SplineSpace<dim> &space = simulation.space();
    while (simulation.state().n_steps < n_steps)
      simulation.step();

    std::vector<const MaterialPoints<dim> *> points;
    for (const Body<dim> &body : simulation.bodies())
      points.push_back(&body.points);
    PointTransfer<dim> transfer;
    transfer.reinit(space);
    std::vector<double> filled;
    transfer.filling(points, filled);
    CellFilling<dim> filling(space);
    filling.update(filled, parameters.scheme.filling);
    Extension<dim> extension;
    extension.reinit(space, filling);
    ExtendedMass<dim> mass;
    mass.reinit(space);
    mass.begin(extension, true);
    transfer.add_mass_matrix(points, mass.matrix());
    mass.finish();
    mass.unknowns().constrain(std::vector<unsigned char>(
      space.owned_functions().size() + space.ghost_functions().size(), 0));
    const UpperTriangle entries = mass.local_entries((1 << dim) - 1);
    const unsigned int  n       = entries.size();

    std::mt19937                     engine;
    std::normal_distribution<double> normal;
    VectorField<dim>                 b[n_fields], x[n_fields];
    for (unsigned int k = 0; k < n_fields; ++k)
      for (unsigned int c = 0; c < dim; ++c)
        {
          space.initialize_vector(b[k][c]);
          space.initialize_vector(x[k][c]);
          for (auto &value : b[k][c])
            value = normal(engine);
        }
    VectorType rows;
    mass.unknowns().initialize_vector(rows, width);
    mass.unknowns().restrict_fields(rows, {&b[0], &b[1]}, width);

    std::vector<Method> methods;

    IncompleteCholesky cholesky;
    SolverParameters   solver_parameters = parameters.solver;
    solver_parameters.tolerance          = parameters.solver.tight_tolerance();
    ExtendedMassSolver<dim> solver(mass, solver_parameters);
    solver.update(0.);
    methods.push_back(
      {"own",
       [&]() { cholesky.factorize(entries); },
       [&]() {
         for (auto &field : x)
           for (auto &component : field)
             component = 0.;
         return int(*solver.solve({&x[0], &x[1]}, {&b[0], &b[1]}).iterations);
       },
       {},
       {}});

    std::vector<PetscMatrix> matrices;
    std::vector<PetscSolver> solvers;
    PetscVector              right, solution;
    for (const bool symmetric : {false, true})
      {
        matrices.push_back(petsc_matrix(entries, symmetric));
        const Mat matrix = matrices.back().get();
        KSP       ksp;
        check_petsc(KSPCreate(PETSC_COMM_SELF, &ksp));
        solvers.emplace_back(ksp);
        check_petsc(KSPSetType(ksp, KSPCG));
        check_petsc(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
        check_petsc(KSPSetTolerances(ksp,
                                     parameters.solver.tight_tolerance(),
                                     PETSC_DEFAULT,
                                     PETSC_DEFAULT,
                                     1000));
        PC pc;
        check_petsc(KSPGetPC(ksp, &pc));
        check_petsc(PCSetType(pc, PCICC));
        methods.push_back(
          {std::string("PETSc, ") + (symmetric ? "SBAIJ" : "AIJ"),
           [=]() {
             // An assembly invalidates the factors, even of an unchanged
             // matrix.
             check_petsc(KSPSetOperators(ksp, matrix, matrix));
             check_petsc(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
             check_petsc(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
             check_petsc(KSPSetUp(ksp));
           },
           [&, ksp]() {
             PetscInt most = 0;
             for (unsigned int c = 0; c < n_columns; ++c)
               {
                 PetscScalar *values;
                 check_petsc(VecGetArray(right.get(), &values));
                 for (unsigned int u = 0; u < n; ++u)
                   values[u] = rows.local_element(u * width + c);
                 check_petsc(VecRestoreArray(right.get(), &values));
                 check_petsc(KSPSolve(ksp, right.get(), solution.get()));
                 KSPConvergedReason reason;
                 check_petsc(KSPGetConvergedReason(ksp, &reason));
                 AssertThrow(reason > 0, ExcMessage("PETSc did not converge."));
                 PetscInt iterations;
                 check_petsc(KSPGetIterationNumber(ksp, &iterations));
                 most = std::max(most, iterations);
               }
             return int(most);
           },
           {},
           {}});
      }
    Vec vector;
    check_petsc(MatCreateVecs(matrices[0].get(), &vector, nullptr));
    right.reset(vector);
    check_petsc(VecDuplicate(vector, &vector));
    solution.reset(vector);

    for (unsigned int round = 0; round <= n_rounds; ++round)
      for (Method &method : methods)
        {
          const double factorization = cpu_milliseconds(method.factorize);
          const double solve =
            cpu_milliseconds([&]() { method.iterations = method.solve(); });
          if (round == 0) // memory is touched for the first time
            continue;
          method.factorizations.push_back(factorization);
          method.solves.push_back(solve);
        }

    std::printf("%dD, p = %u: %u unknowns, %zu entries in the lower triangle, "
                "tolerance %g, %u columns\n\n"
                "| solver | IC(0), ms | solve, ms | iterations | IC(0) / own | "
                "solve / own |\n| --- | --- | --- | --- | --- | --- |\n",
                dim,
                space.degree(),
                n,
                entries.values.size(),
                parameters.solver.tight_tolerance(),
                n_columns);
    for (const Method &method : methods)
      {
        const auto ratio = [&](const std::vector<double> &times,
                               const std::vector<double> &own) {
          std::vector<double> ratios;
          for (unsigned int k = 0; k < times.size(); ++k)
            ratios.push_back(times[k] / own[k]);
          return median(ratios);
        };
        std::printf("| %s | %.2f | %.2f | %d | %.2f | %.2f |\n",
                    method.name.c_str(),
                    median(method.factorizations),
                    median(method.solves),
                    method.iterations,
                    ratio(method.factorizations, methods[0].factorizations),
                    ratio(method.solves, methods[0].solves));
      }
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  if (argc < 2 || argc > 4)
    {
      std::cerr << "usage: solver_benchmark FILE.prm [STEPS [ROUNDS]]\n";
      return 2;
    }
  try
    {
      const SimulationParameters parameters(argv[1]);
      const unsigned int         n_steps =
        argc > 2 ? Utilities::string_to_int(argv[2]) : 0;
      const unsigned int n_rounds =
        argc > 3 ? Utilities::string_to_int(argv[3]) : 9;
      if (parameters.general.dimension == 2)
        measure<2>(parameters, n_steps, n_rounds);
      else
        measure<3>(parameters, n_steps, n_rounds);
    }
  catch (const std::exception &exception)
    {
      std::cerr << exception.what() << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 1);
    }
  return 0;
}

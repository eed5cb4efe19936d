// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks every smoother by name: its transpose is correct, symmetric smoothers
// are symmetric, and CG with it needs an expected number of iterations. Every
// smoother parameter has an effect.

#include <deal.II/lac/solver_cg.h>

#include <greville/multigrid/smoother.h>
#include <greville/paper/assembled_mass_level.h>
#include <greville/paper/paper_parts.h>

#include <density.h>

namespace
{
  unsigned int
  count_cg(const AssembledMassLevel<2> &level,
           const Preconditioner        &preconditioner)
  {
    const VectorType     x = pseudo_random_vector(level.space());
    VectorType           b(x), solution(x);
    SolverControl        control(1000, 1e-8 * b.l2_norm(), false, false);
    SolverCG<VectorType> cg(control);
    solution = 0.;
    try
      {
        cg.solve(level, solution, b, preconditioner);
      }
    catch (const SolverControl::NoConvergence &)
      {}
    return control.last_step();
  }

  // A number that changes with the preconditioner.
  double
  signature(const AssembledMassLevel<2> &level,
            const Preconditioner        &preconditioner)
  {
    const VectorType x = pseudo_random_vector(level.space());
    VectorType       y(x), My(x);
    preconditioner.vmult(y, x);
    level.vmult(My, y);
    return y * My / (x * x);
  }
} // namespace



void
test_main()
{
  add_paper_parts();
  const bool alone = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1;
  Box<2>     box(MultiIndex<2>{{16, 16}});
  const SplineSpace<2>  space(box.mesh, 3);
  AssembledMassLevel<2> level(space, *density<2>("smooth"));
  level.assemble(true, false);

  const std::vector<std::tuple<std::string, unsigned int, unsigned int>> names =
    {{"ilut", 1, 14},
     {"ilu0", 1, 14},
     {"ict", 2, 10},
     {"ic0", 1, 14},
     {"jacobi", 100, 260},
     {"symmetric-gauss-seidel", 25, 80},
     {"chebyshev", 30, 90},
     {"chebyshev-ic0", 1, 14},
     {"tensor-product", 5, 25},
     {"petsc", 2, 60}};
  std::string all;
  for (const auto &entry : names)
    {
      const std::string  name = std::get<0>(entry);
      SmootherParameters parameters;
      const auto smoother = make_smoother<2>(name, parameters, level, true);
      print() << name << std::endl;
      check_range("  iterations of CG",
                  count_cg(level, *smoother),
                  std::get<1>(entry),
                  std::get<2>(entry));
      const VectorType x = pseudo_random_vector(space);
      VectorType       y(x), Sx(x), Sy(x), STy(x);
      for (unsigned int i = 0; i < y.locally_owned_size(); ++i)
        y.local_element(i) = std::cos(5. * x.local_element(i));
      smoother->vmult(Sx, x);
      smoother->vmult(Sy, y);
      smoother->Tvmult(STy, y);
      const double scale = Sx.l2_norm() * y.l2_norm();
      // Cholesky factors are in single precision.
      const bool single =
        name == "ict" || name == "ic0" || name == "chebyshev-ic0";
      const double bound = single ? 1e-6 : 1e-12;
      check("  transpose", std::abs(Sx * y - x * STy) / scale, bound);
      // ILUT drops row by row.
      if (name != "ilut")
        check("  symmetry", std::abs(Sx * y - x * Sy) / scale, bound);
    }

  // Restricted combinations and Gauss-Seidel are not symmetric, but have a
  // transpose.
  for (const std::string name : {"ilut", "ic0", "gauss-seidel"})
    {
      SmootherParameters parameters;
      parameters.combination = "restricted";
      const auto smoother    = make_smoother<2>(name, parameters, level, false);
      const VectorType x     = pseudo_random_vector(space);
      VectorType       y(x), Sx(x), STy(x);
      for (unsigned int i = 0; i < y.locally_owned_size(); ++i)
        y.local_element(i) = std::cos(5. * x.local_element(i));
      smoother->vmult(Sx, x);
      smoother->Tvmult(STy, y);
      check(name + ", restricted: transpose",
            std::abs(Sx * y - x * STy) / (Sx.l2_norm() * y.l2_norm()),
            name == "ic0" ? 1e-6 : 1e-12);
    }

  // Each parameter has an effect.
  const auto effect =
    [&](const std::string                               &what,
        const std::string                               &name,
        const std::function<void(SmootherParameters &)> &set) {
      SmootherParameters parameters, changed;
      set(changed);
      const double before =
        signature(level, *make_smoother<2>(name, parameters, level, false));
      const double after =
        signature(level, *make_smoother<2>(name, changed, level, false));
      check(name + ", effect of " + what,
            std::abs(before - after) > 1e-12 * std::abs(before));
    };
  effect("drop tolerance", "ilut", [](auto &p) { p.drop_tolerance = 1e-2; });
  effect("fill factor", "ilut", [](auto &p) { p.fill_factor = 0.3; });
  effect("shift", "ict", [](auto &p) { p.shift = 0.02; });
  effect("shift", "ic0", [](auto &p) { p.shift = 0.01; });
  effect("shift", "ilu0", [](auto &p) { p.shift = 0.01; });
  effect("ordering", "ic0", [](auto &p) { p.ordering = "rcm"; });
  effect("ordering", "ilut", [](auto &p) { p.ordering = "amd"; });
  effect("damping", "jacobi", [](auto &p) { p.damping = 0.7; });
  effect("degree", "chebyshev", [](auto &p) { p.chebyshev_degree = 2; });
  effect("range", "chebyshev", [](auto &p) { p.chebyshev_range = 5; });
  effect("options", "petsc", [](auto &p) {
    p.petsc_options = "-pc_type jacobi";
  });
  if (!alone)
    effect("overlap", "ic0", [](auto &p) { p.overlap = 0; });

  // A smoother that cannot be made gives the reason.
  for (const std::string options :
       {"-pc_type no_such", "-pc_type jacobi -pc_no_such 3"})
    try
      {
        SmootherParameters parameters;
        parameters.petsc_options = options;
        make_smoother<2>("petsc", parameters, level, false);
        print() << "accepted" << std::endl;
      }
    catch (const std::exception &error)
      {
        print() << message_of(error) << std::endl;
      }
  try
    {
      SmootherParameters parameters;
      make_smoother<2>("no such", parameters, level, false);
    }
  catch (const std::exception &error)
    {
      print() << message_of(error) << std::endl;
    }
}

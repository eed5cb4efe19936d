// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2 3

// Checks extended B-splines: a level, applied and assembled, equals the dense
// matrix E^T M~ E, with coefficients constrained at a wall and lumped
// fragments, on any number of processes. Transfers preserve constants and agree
// with their transposes, and solvers converge.

#include <greville/paper/mass_solver.h>
#include <greville/paper/paper_parts.h>

#include <dense.h>
#include <filling.h>

// Weights where cells are filled, more or less at random.
template <int dim>
void
fill_weights(DensityWeights<dim>    &weights,
             const SplineSpace<dim> &space,
             const Filling<dim>     &filling,
             const double            amplitude = 1.)
{
  const std::vector<double> parts = fillings<dim>(space, filling);
  for (unsigned int c = 0; c < parts.size(); ++c)
    for (unsigned int q = 0; q < weights.n_points(); ++q)
      weights.at_cell(c)[q * CellBatches<dim>::width()] =
        parts[c] *
        (1.2 + amplitude * pseudo_random(space.owned_cells()[c] * 1000 + q)) /
        weights.n_points();
}



template <int dim>
void
test(const MultiIndex<dim> &cells,
     const unsigned int     p,
     const Filling<dim>    &is_filled,
     const bool             is_constrained,
     const std::string     &name)
{
  print() << dim << "D, p = " << p << ", " << name
          << (is_constrained ? ", held at a wall" : "") << std::endl;
  // Coefficients constrained at the lower wall in the last direction.
  const auto is_at_floor = [&](const SplineSpace<dim> &space,
                               const std::uint64_t     position) {
    return is_constrained &&
           multi_index<dim>(position, space.n_functions())[dim - 1] == 0;
  };
  // Once on all processes, and on each alone.
  Box<dim>               box(cells), own_box(cells, MPI_COMM_SELF);
  const SplineSpace<dim> space(box.mesh, p), own_space(own_box.mesh, p);
  CellFilling<dim>       filling(space), own_filling(own_space);
  filling.update(fillings<dim>(space, is_filled), 0.8);
  own_filling.update(fillings<dim>(own_space, is_filled), 0.8);
  const Extension<dim> extension(space, filling);
  const Extension<dim> own_extension(own_space, own_filling);

  DensityWeights<dim> own_weights(own_space, 2 * p + 1);
  fill_weights<dim>(own_weights, own_space, is_filled);
  const FullMatrix<double> exact = dense<dim>(
    own_space, own_weights, own_extension, [&](const std::uint64_t position) {
      return is_at_floor(own_space, position);
    });
  double largest = 0.;
  for (unsigned int i = 0; i < exact.m(); ++i)
    largest = std::max(largest, exact(i, i));

  AssembledMassLevel<dim> free(space, DensityWeights<dim>(space, 2 * p + 1));
  fill_weights<dim>(free.weights(), space, is_filled);
  std::vector<unsigned char> constrained;
  for (unsigned int f = 0;
       f < space.owned_functions().size() + space.ghost_functions().size();
       ++f)
    constrained.push_back(is_at_floor(space, space.function_position(f)));
  free.extend(extension, constrained);
  free.assemble(false, false);
  const VectorType diagonal = free.diagonal();
  free.assemble(true, false);
  // A second assembly gives the same matrix.
  free.assemble(true, false);

  const VectorType x = pseudo_random_vector(space);
  VectorType       y(x), z(x), sums(x), wanted(x), wanted_diagonal(x), one(x);
  free.vmult(y, x);
  free.assembled()->vmult(z, x);
  one = 1.;
  for (const unsigned int i : free.inactive())
    one.local_element(i) = 0.;
  for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
    {
      const unsigned int row = space.owned_functions()[i];
      double             sum = 0.;
      for (unsigned int j = 0; j < exact.n(); ++j)
        sum += exact(row, j) * pseudo_random(j);
      const bool is_active    = exact(row, row) > 1e-15 * largest;
      wanted.local_element(i) = is_active ? sum : largest * x.local_element(i);
      wanted_diagonal.local_element(i) = is_active ? exact(row, row) : largest;
    }
  check("  matrix-free", difference(y, wanted), 1e-12);
  check("  assembled", difference(z, wanted), 1e-12);
  check("  diagonal, matrix-free",
        difference(diagonal, wanted_diagonal),
        1e-12);
  check("  diagonal, assembled",
        difference(free.diagonal(), wanted_diagonal),
        1e-12);
  VectorType u(x), Mu(x);
  for (unsigned int i = 0; i < u.locally_owned_size(); ++i)
    u.local_element(i) = std::cos(3. * x.local_element(i));
  free.vmult(Mu, u);
  check("  symmetric",
        std::abs(y * u - x * Mu) / (y.l2_norm() * u.l2_norm()),
        1e-13);
  const auto counts = extension.counts();
  const auto n_active =
    space.n_dofs() -
    Utilities::MPI::sum(free.inactive().size(), MPI_COMM_WORLD);
  print() << "  " << counts.stable << " stable, " << counts.extended
          << " extended, " << counts.lumped << " lumped, active " << n_active
          << std::endl;

  // Mass, and the row sums.
  free.mass().cross_mass().row_sums(sums);
  double mass = 0.;
  for (unsigned int i = 0; i < sums.locally_owned_size(); ++i)
    mass += sums.local_element(i);
  mass = Utilities::MPI::sum(mass, MPI_COMM_WORLD);
  print() << "  mass " << std::setprecision(4) << mass << std::endl;
  if (is_constrained)
    return;
  free.vmult(y, one);
  check("  keeps the mass", std::abs(y * one / mass - 1.), 1e-12);
  VectorType lumped = free.lumped();
  lumped.scale(one);
  lumped -= y;
  check("  row sums", lumped.l2_norm() / y.l2_norm(), 1e-11);
}



template <int dim>
void
test_transfer(const MultiIndex<dim> &cells,
              const unsigned int     p,
              const unsigned int     q,
              const Filling<dim>    &is_filled)
{
  print() << dim << "D, orders " << q << " and " << p << std::endl;
  Box<dim>               box(cells);
  const SplineSpace<dim> fine(box.mesh, p), coarse(box.mesh, q);
  CellFilling<dim>       filling(fine);
  filling.update(fillings<dim>(fine, is_filled), 0.8);
  AssembledMassLevel<dim> fine_level(fine,
                                     DensityWeights<dim>(fine, 2 * p + 1));
  AssembledMassLevel<dim> coarse_level(coarse,
                                       DensityWeights<dim>(coarse, 2 * q + 1));
  for (AssembledMassLevel<dim> *level : {&coarse_level, &fine_level})
    {
      fill_weights<dim>(level->weights(), level->space(), is_filled);
      const Extension<dim> extension(level->space(), filling);
      level->extend(extension);
      level->assemble(false, false);
    }
  for (const std::string prolongation : {"lumped-l2", "exact-l2"})
    {
      const std::string name = "  " + prolongation + ": ";
      const std::vector<const LevelOperator<dim> *> levels{&coarse_level,
                                                           &fine_level};
      const OrderTransfer<dim>                      transposed(levels,
                                          prolongation,
                                          "transpose",
                                          TransferWeight::density);
      VectorType e = pseudo_random_vector(coarse), r(e);
      VectorType f = pseudo_random_vector(fine), Ie(f);
      transposed.prolongate(1, Ie, e);
      r = 0.;
      transposed.restrict_and_add(1, r, f);
      check(name + "transpose",
            std::abs(Ie * f - e * r) / (Ie.l2_norm() * f.l2_norm()),
            1e-13);
      double inactive = 0.;
      for (const unsigned int i : fine_level.inactive())
        inactive += std::abs(Ie.local_element(i));
      for (const unsigned int i : coarse_level.inactive())
        inactive += std::abs(r.local_element(i));
      check(name + "inactive coefficients", max_all(inactive), 0.);

      if (prolongation == "lumped-l2")
        {
          const OrderTransfer<dim> own(levels,
                                       "lumped-l2",
                                       "lumped-l2",
                                       TransferWeight::density);
          e = 1.;
          own.prolongate(1, Ie, e);
          for (const unsigned int i : fine_level.inactive())
            Ie.local_element(i) = 1.;
          Ie.add(-1.);
          f = 1.;
          r = 0.;
          own.restrict_and_add(1, r, f);
          for (const unsigned int i : coarse_level.inactive())
            r.local_element(i) = 1.;
          r.add(-1.);
          check(name + "constants",
                std::max(Ie.linfty_norm(), r.linfty_norm()),
                1e-11);
        }
    }
}



template <int dim>
void
test_solvers(const MultiIndex<dim> &cells,
             const unsigned int     p,
             const Filling<dim>    &is_filled)
{
  print() << dim << "D, p = " << p << ": solvers" << std::endl;
  Box<dim>                 box(cells);
  MassSolverParameters     solver_parameters;
  PaperMultigridParameters multigrid;
  SmootherParameters       smoother;
  solver_parameters.tolerance = 1e-10;
  multigrid.restriction       = "transpose";
  // Extended functions couple over more than one cell.
  smoother.overlap = 2;
  VectorType reference;
  const auto run = [&](const std::string &name,
                       const Coarsening   coarsening,
                       const std::string &smoother_name) {
    multigrid.coarsening = coarsening;
    multigrid.smoother   = smoother_name;
    const OrderHierarchy<dim> orders(box.mesh, p, coarsening);
    CellFilling<dim>          filling(orders.finest());
    filling.update(fillings<dim>(orders.finest(), is_filled), 0.8);
    MassHierarchy<dim> mass(orders);
    for (const auto &level : mass.all_levels())
      {
        fill_weights<dim>(level->weights(), level->space(), is_filled, 0.1);
        const Extension<dim> extension(level->space(), filling);
        level->extend(extension);
      }
    MassSolver<dim> solver(name, mass, solver_parameters, multigrid, smoother);
    solver.assemble();
    solver.setup();
    VectorType x = pseudo_random_vector(orders.finest()), b(x);
    mass.finest().condense(b);
    const SolveResult result = solver.solve(x, b);
    if (reference.size() == 0)
      reference = x;
    check("  " + name + ", " + word_of(coarsening, coarsenings) + ", " +
            smoother_name +
            (result.reason.empty() ? "" : " (" + result.reason + ")"),
          result.converged ? difference(x, reference) : 1.,
          1e-6);
    return result.iterations.value_or(0);
  };
  for (const Coarsening coarsening :
       {Coarsening::one_by_one, Coarsening::direct, Coarsening::none})
    {
      const unsigned int n = run("cg-p-multigrid", coarsening, "ic0");
      check_range("  iterations", n, 1, 40);
    }
  check_range("  iterations",
              run("cg-p-multigrid", Coarsening::direct, "ict"),
              1,
              20);
  check_range("  iterations",
              run("cg-smoother", Coarsening::direct, "ict"),
              1,
              20);
  run("cg-jacobi", Coarsening::none, "");
  run("cg-p-multigrid", Coarsening::none, "jacobi");
  run("cg-p-multigrid", Coarsening::by_two, "chebyshev");
}



void
test_main()
{
  add_paper_parts();
  // A body at two walls with a fringe, a strip, and a fragment.
  const Filling<2> drawn = drawing({"..........++",
                                    "##++.....+++",
                                    "####++..+++.",
                                    "#####+......",
                                    "#####+...+#.",
                                    "#####+...+#.",
                                    "####++....#."});
  for (unsigned int p = 1; p <= 5; ++p)
    for (const bool is_constrained : {false, true})
      test<2>({{12, 7}}, p, drawn, is_constrained, "drawing");
  test<2>(
    {{12, 7}}, 2, [](const MultiIndex<2> &) { return 1.; }, true, "full");
  for (unsigned int p = 1; p <= 3; ++p)
    test<3>(cube<3>(6), p, ball<3>(6, 2.5, 1.8), p == 2, "ball");

  test_transfer<2>({{12, 7}}, 2, 1, drawn);
  test_transfer<2>({{12, 7}}, 3, 2, drawn);
  test_transfer<2>({{12, 7}}, 5, 1, drawn);
  test_transfer<3>(cube<3>(6), 2, 1, ball<3>(6, 2.5, 1.8));

  test_solvers<2>({{12, 7}}, 2, drawn);
  test_solvers<2>(cube<2>(12), 2, ball<2>(12, 6., 4.6));
  test_solvers<3>(cube<3>(6), 1, ball<3>(6, 2., 3.2));
}

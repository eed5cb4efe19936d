// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks FGMRES in solve_krylov() with a preconditioner that changes and is bad
// for some rows: the estimated residual is the residual of the solution.
// Classical Gram-Schmidt with delayed corrections (deal.II 9.6.2) ends with a
// residual of 0.019. Conjugate gradients for an indefinite matrix continue as
// FGMRES.

#include <deal.II/lac/full_matrix.h>

#include <greville/linear_algebra/krylov.h>

#include <cmath>
#include <random>
#include <tests.h>

void
test_main()
{
  constexpr unsigned int n     = 60;
  const auto             scale = [](const unsigned int i) {
    return std::pow(10., 0.2 * (i * 7 % 11) - 1.);
  };
  std::mt19937 generator(1);
  const auto   random = [&]() {
    return 2. * generator() / std::pow(2., 32) - 1.;
  };
  FullMatrix<double> matrix(n, n);
  for (unsigned int i = 0; i < n; ++i)
    for (unsigned int j = 0; j < n; ++j)
      matrix(i, j) =
        scale(i) * scale(j) * ((i == j ? 2. : 0.) + 0.1 * random());
  const auto product = [&](VectorType &dst, const VectorType &src) {
    for (unsigned int i = 0; i < n; ++i)
      {
        double sum = 0.;
        for (unsigned int j = 0; j < n; ++j)
          sum += matrix(i, j) * src.local_element(j);
        dst.local_element(i) = sum;
      }
  };
  unsigned int n_calls        = 0;
  const auto   preconditioner = [&](VectorType &dst, const VectorType &src) {
    ++n_calls;
    for (unsigned int i = 0; i < n; ++i)
      dst.local_element(i) = src.local_element(i) / matrix(i, i) *
                             (i % 11 == 3  ? 1e4
                                : i % 7 == 2 ? 1e-5
                                             : 1.) *
                             (1. + 0.1 * ((n_calls * 7 + i * 3) % 5));
  };
  VectorType b(n), x(n), residual(n);
  for (unsigned int i = 0; i < n; ++i)
    b.local_element(i) = random();
  SolverParameters parameters;
  parameters.tolerance      = 1e-8;
  parameters.max_iterations = 200;
  const SolveResult result =
    solve_krylov(parameters, product, preconditioner, x, b, 100);
  check("FGMRES converges", result.converged);
  check_range("iterations", *result.iterations, 55, 65);
  product(residual, x);
  residual -= b;
  check("residual of the solution", residual.l2_norm() / b.l2_norm(), 2e-3);

  // Eight different eigenvalues.
  const auto indefinite = [&](VectorType &dst, const VectorType &src) {
    for (unsigned int i = 0; i < n; ++i)
      dst.local_element(i) =
        (i < n / 2 ? 1. + i % 5 : -0.5 - i % 3) * src.local_element(i);
  };
  const auto copy = [](VectorType &dst, const VectorType &src) { dst = src; };
  const SolveResult of_cg = solve_krylov(parameters, indefinite, copy, x, b);
  check("an indefinite matrix", of_cg.converged);
  check_range("iterations", *of_cg.iterations, 8, 12);
  indefinite(residual, x);
  residual -= b;
  check("residual", residual.l2_norm() / b.l2_norm(), 1e-7);
}

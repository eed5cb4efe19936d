// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks the largest eigenvalue of B S against LAPACK, from an arbitrary start
// and from the vector of a slightly different problem. S is the second
// difference of n unknowns, and B the inverse of different masses, some of them
// constrained.
#include <deal.II/lac/lapack_full_matrix.h>

#include <greville/base/largest_eigenvalue.h>

#include <cmath>
#include <tests.h>

constexpr unsigned int n = 120;



double
inverse_mass(const unsigned int i, const double change)
{
  return i % 17 == 5 ? 0. : 1. / (1. + 0.5 * std::sin(0.1 * i + change));
}



double
from_lapack(const double change)
{
  LAPACKFullMatrix<double> matrix(n, n);
  for (unsigned int i = 0; i < n; ++i)
    for (unsigned int j = 0; j < n; ++j)
      if (i == j || i + 1 == j || j + 1 == i)
        matrix(i, j) = (i == j ? 2. : -1.) * std::sqrt(inverse_mass(i, change) *
                                                       inverse_mass(j, change));
  matrix.compute_eigenvalues();
  double largest = 0.;
  for (unsigned int i = 0; i < n; ++i)
    largest = std::max(largest, matrix.eigenvalue(i).real());
  return largest;
}



void
test_main()
{
  // Processes have different numbers of unknowns, the last one of several none.
  const unsigned int n_parts =
    std::max(1u, Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) - 1);
  const unsigned int rank  = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  const unsigned int begin = std::min(n, rank * (n / n_parts));
  const unsigned int end   = rank + 1 < n_parts
                               ? begin + n / n_parts
                               : (rank + 1 == n_parts ? n : begin);

  const LinearAction multiply_by_S = [&](std::vector<double>       &y,
                                         const std::vector<double> &x) {
    std::vector<double> all(n);
    for (unsigned int i = begin; i < end; ++i)
      all[i] = x[i - begin];
    Utilities::MPI::sum(all, MPI_COMM_WORLD, all);
    for (unsigned int i = begin; i < end; ++i)
      y[i - begin] =
        2. * all[i] - (i > 0 ? all[i - 1] : 0.) - (i + 1 < n ? all[i + 1] : 0.);
  };
  const auto solve = [&](const double change) {
    return LinearAction(
      [&, change](std::vector<double> &y, const std::vector<double> &x) {
        for (unsigned int i = begin; i < end; ++i)
          y[i - begin] = inverse_mass(i, change) * x[i - begin];
      });
  };
  std::vector<double> start(end - begin);
  for (unsigned int i = begin; i < end; ++i)
    start[i - begin] = pseudo_random(i);

  const auto find = [&](const double               change,
                        const std::vector<double> &from,
                        const double               tolerance) {
    return largest_eigenvalue(
      multiply_by_S, solve(change), from, tolerance, 100, MPI_COMM_WORLD);
  };
  const LargestEigenvalue exact = find(0., start, 1e-12);
  print() << "largest eigenvalue: " << exact.value << std::endl;
  check("that of LAPACK", std::abs(exact.value / from_lapack(0.) - 1.), 1e-9);
  double              square = 0., difference = 0.;
  std::vector<double> S_x(end - begin), B_b(end - begin);
  multiply_by_S(S_x, exact.x);
  solve(0.)(B_b, exact.b);
  for (unsigned int i = begin; i < end; ++i)
    {
      const unsigned int u = i - begin;
      square += exact.x[u] * exact.b[u];
      difference = std::max(difference, std::abs(B_b[u] - exact.x[u]));
      if (inverse_mass(i, 0.) > 0.)
        difference =
          std::max(difference, std::abs(S_x[u] - exact.value * exact.b[u]));
    }
  check("norm of the eigenvector",
        std::abs(Utilities::MPI::sum(square, MPI_COMM_WORLD) - 1.),
        1e-10);
  check("eigenvector", max_all(difference), 1e-4);

  // The change per step is the error, but for a factor.
  const LargestEigenvalue coarse = find(0., start, 1e-2);
  check("tolerance of 1 %", 1. - coarse.value / exact.value, 0.05);
  check("from below", coarse.value <= exact.value * (1. + 1e-12));
  check_range("products", coarse.n_products, 4, 20);

  // Another problem, from the vector of the first.
  const LargestEigenvalue again = find(0.02, exact.b, 1e-2);
  check("start from a vector",
        std::abs(again.value / from_lapack(0.02) - 1.),
        1e-3);
  check_range("products from it", again.n_products, 2, 4);

  // Nothing to start from.
  check("zero", find(0., std::vector<double>(end - begin), 1e-2).value, 0.);
}

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

// Shared by all tests. A test is a file with a function test_main(), which runs
// with MPI initialized. The first process prints numbers, which are compared
// with the .output file. The program itself checks claims with check(), above
// all residuals at round-off, because numdiff treats values below 1e-6 as zero.

#include <deal.II/base/function.h>
#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/spline/spline_space.h>

#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

using namespace dealii;
using namespace greville;

// The command-line arguments after the name of the test.
inline std::vector<std::string> &
test_arguments()
{
  static std::vector<std::string> arguments;
  return arguments;
}



inline std::ostream &
print(const MPI_Comm comm = MPI_COMM_WORLD)
{
  static std::ostream nowhere(nullptr);
  return Utilities::MPI::this_mpi_process(comm) == 0 ? std::cout : nowhere;
}



// Counts the checks of a program. At the end, the first process prints their
// number, so that a skipped check changes the output. A process with a failed
// check exits with 1, which deal.II's test driver reports together with the
// claims.
class Checks
{
public:
  ~Checks()
  {
    if (process == 0)
      std::cout << n_checks << " checks" << std::endl;
    if (n_failed > 0)
      std::_Exit(1);
  }

  // Return the stream for a failed claim.
  std::ostream &
  failed()
  {
    ++n_failed;
    std::cout << "FAILED";
    if (process > 0)
      std::cout << " on process " << process;
    return std::cout << ": ";
  }

  unsigned int n_checks = 0;

private:
  const unsigned int process = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  unsigned int       n_failed = 0;
};

inline Checks &
next_check()
{
  static Checks checks;
  ++checks.n_checks;
  return checks;
}



// Print nothing unless the bound is missed or the value is NaN.
inline void
check(const std::string &what, const double value, const double bound)
{
  Checks &checks = next_check();
  if (!(value <= bound))
    checks.failed() << what << ": " << value << " > " << bound << std::endl;
}



inline void
check(const std::string &what, const bool condition)
{
  Checks &checks = next_check();
  if (!condition)
    checks.failed() << what << std::endl;
}



// Check that a count is in a range.
inline void
check_range(const std::string &what,
            const unsigned int value,
            const unsigned int smallest,
            const unsigned int largest)
{
  Checks &checks = next_check();
  if (value < smallest || value > largest)
    checks.failed() << what << ": " << value << " is not between " << smallest
                    << " and " << largest << std::endl;
}



// A box mesh that lives as long as its spaces need it.
template <int dim>
struct Box
{
  // Cells that are not uniform are between 0.3 and 1.7 times the mean, in no
  // order.
  Box(const MultiIndex<dim>       &cells,
      const MPI_Comm               comm       = MPI_COMM_WORLD,
      const std::array<bool, dim> &periodic   = {},
      const bool                   is_uniform = true)
    : mesh(comm, Triangulation<dim>::none, mesh_settings<dim>)
  {
    Point<dim>     upper;
    CellEdges<dim> edges;
    for (unsigned int d = 0; d < dim; ++d)
      {
        upper[d] = 1. + 0.5 * d;
        for (unsigned int k = 0; k <= cells[d] && !is_uniform && !periodic[d];
             ++k)
          edges[d].push_back(
            k == cells[d]
              ? upper[d]
              : upper[d] * (k + (k == 0 ? 0. : 0.35 * std::sin(2.6 * k + d))) /
                  cells[d]);
      }
    create_box_mesh<dim>(mesh, Point<dim>(), upper, cells, periodic, edges);
  }

  DistributedTriangulation<dim> mesh;
};



template <int dim>
MultiIndex<dim>
cube(const unsigned int n)
{
  MultiIndex<dim> cells;
  cells.fill(n);
  return cells;
}



// Return a number between -1 and 1 that depends only on the position of a
// function.
inline double
pseudo_random(const std::uint64_t position)
{
  const double x = std::sin(12.9898 * (position % 100003) + 0.7) * 43758.5453;
  return 2. * (x - std::floor(x)) - 1.;
}



template <int dim>
VectorType
pseudo_random_vector(const SplineSpace<dim> &space)
{
  VectorType vector;
  space.initialize_vector(vector);
  for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
    vector.local_element(i) = pseudo_random(space.owned_functions()[i]);
  return vector;
}



// Return the relative difference of two vectors.
inline double
difference(const VectorType &a, const VectorType &b)
{
  VectorType d(a);
  d -= b;
  return d.l2_norm() / std::max(b.l2_norm(), 1e-300);
}



inline double
max_all(const double value)
{
  return Utilities::MPI::max(value, MPI_COMM_WORLD);
}

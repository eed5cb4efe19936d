// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/timer.h>

#include <greville/benchmark/operators.h>
#include <greville/paper/tensor_product_solver.h>

#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  OperatorRecord
  measure_operators(AssembledMassLevel<dim> &level)
  {
    const SplineSpace<dim> &space = level.space();
    level.assemble(true, false);
    const TensorProductSolver<dim>         solver(space);
    const TensorProductPreconditioner<dim> inverse(solver,
                                                   level.diagonal(),
                                                   level.inactive());
    VectorType                             x, y;
    space.initialize_vector(x);
    space.initialize_vector(y);
    x = 1.;

    const auto rate = [&](const auto &apply) {
      // Best of some groups of about 0.05 s.
      apply();
      Timer once;
      apply();
      const double first =
        Utilities::MPI::max(once.wall_time(), space.communicator());
      const unsigned int n    = std::max(1., std::ceil(0.05 / first));
      double             best = std::numeric_limits<double>::max();
      for (unsigned int group = 0; group < 5; ++group)
        {
          MPI_Barrier(space.communicator());
          Timer timer;
          for (unsigned int i = 0; i < n; ++i)
            apply();
          best = std::min(best,
                          Utilities::MPI::max(timer.wall_time(),
                                              space.communicator()) /
                            n);
        }
      return space.n_dofs() / best;
    };

    OperatorRecord record;
    record.dim         = dim;
    record.p           = space.degree();
    record.processes   = Utilities::MPI::n_mpi_processes(space.communicator());
    record.unknowns    = space.n_dofs();
    record.matrix_free = rate([&]() { level.mass().vmult(y, x); });
    record.assembled   = rate([&]() { level.assembled()->vmult(y, x); });
    record.tensor_product = rate([&]() { inverse.vmult(y, x); });
    record.bytes_sent =
      Utilities::MPI::sum(static_cast<unsigned long>(solver.bytes_sent()),
                          space.communicator());
    record.matrix_bytes =
      Utilities::MPI::sum(static_cast<unsigned long>(
                            level.assembled()->memory_consumption()),
                          space.communicator());
    level.clear();
    return record;
  }



  double
  measure_bandwidth(const MPI_Comm comm)
  {
    const std::size_t   n = 4000000;
    std::vector<double> a(n, 0.), b(n, 1.), c(n, 2.);
    double              best = 0.;
    for (unsigned int sweep = 0; sweep < 8; ++sweep)
      {
        MPI_Barrier(comm);
        Timer        timer;
        const double s = 0.5 + sweep;
        for (std::size_t i = 0; i < n; ++i)
          a[i] = b[i] + s * c[i];
        std::swap(a, b);
        const double time = Utilities::MPI::max(timer.wall_time(), comm);
        best              = std::max(best, 3. * sizeof(double) * n / time);
      }
    AssertThrow(b[n / 2] > 0., ExcInternalError());
    return best * Utilities::MPI::n_mpi_processes(comm);
  }



  GREVILLE_INSTANTIATE(measure_operators);
} // namespace greville

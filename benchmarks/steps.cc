// SPDX-License-Identifier: LGPL-2.1-or-later

// Measures the time of simulation steps on each process, after a warm-up,
// without start and output. scripts/benchmark runs it in turns for several
// masses and numbers of processes, and prints medians.
//
//   ninja -C build step_benchmark
//   build/step_benchmark FILE.prm MASS [FIRST_STEP LAST_STEP]
//
// prints one line of JSON. A fixed loop of square roots before and after the
// steps shows how busy the machine is.

#include <deal.II/base/mpi.h>

#include <greville/base/json.h>
#include <greville/base/parameters.h>
#include <greville/steps/simulation.h>

#include "timing.h"
#include <chrono>
#include <iostream>

using namespace dealii;
using namespace greville;

namespace
{
  constexpr unsigned int n_roots = 10000000; // of the reference loop

  double
  wall_seconds()
  {
    return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
  }



  template <int dim>
  void
  measure(const SimulationParameters &parameters,
          const unsigned int          first,
          const unsigned int          last)
  {
    const MPI_Comm  comm = MPI_COMM_WORLD;
    Simulation<dim> simulation(parameters, comm);
    const auto      advance = [&](const unsigned int until) {
      while (simulation.state().n_steps < until)
        {
          AssertThrow(!simulation.is_finished(),
                      ExcMessage("The simulation ends before step " +
                                 std::to_string(until) + "."));
          simulation.step();
        }
    };

    advance(first);
    const auto   parts_before      = simulation.step_log().seconds;
    const auto   iterations_before = simulation.state().n_all_iterations;
    const double reference_before  = reference_loop(n_roots);
    MPI_Barrier(comm);
    const double cpu_before = cpu_seconds(), wall_before = wall_seconds();
    advance(last);
    const double cpu = cpu_seconds() - cpu_before;
    MPI_Barrier(comm);
    const double wall      = wall_seconds() - wall_before;
    const double reference = 0.5 * (reference_before + reference_loop(n_roots));

    // Largest number of points of a process, relative to the mean.
    double n_points = 0.;
    for (const Body<dim> &body : simulation.bodies())
      n_points += body.points.n_points();
    const auto all_points = Utilities::MPI::min_max_avg(n_points, comm);

    JsonWriter json;
    json.add("mass", parameters.scheme.mass)
      .add("processes", Utilities::MPI::n_mpi_processes(comm))
      .add("steps", last - first)
      .add("cpu", Utilities::MPI::max(cpu, comm))
      .add("wall", wall)
      .add("reference", Utilities::MPI::max(reference, comm))
      .add("iterations",
           double(simulation.state().n_all_iterations - iterations_before) /
             (last - first))
      .add("factorizations", simulation.mass().n_factorizations())
      .add("balance", all_points.max / all_points.avg)
      .begin("parts");
    for (const auto &part : simulation.step_log().seconds)
      {
        const auto   before = parts_before.find(part.first);
        const double seconds =
          part.second - (before == parts_before.end() ? 0. : before->second);
        const double slowest = Utilities::MPI::max(seconds, comm);
        json.add(part.first, slowest);
      }
    json.end();
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      std::cout << json.text() << std::endl;
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  if (argc != 3 && argc != 5)
    {
      std::cerr << "usage: step_benchmark FILE.prm [total-]MASS [FIRST_STEP "
                   "LAST_STEP]\n";
      return 2;
    }
  try
    {
      SimulationParameters parameters(argv[1]);
      // "total-consistent": total Lagrangian steps.
      const std::string total = "total-", name = argv[2];
      const bool        is_total = name.rfind(total, 0) == 0;
      parameters.scheme.mass     = is_total ? name.substr(total.size()) : name;
      if (is_total)
        parameters.scheme.formulation = "total Lagrangian";
      parameters.check();
      const unsigned int first =
        argc == 5 ? Utilities::string_to_int(argv[3]) : 10;
      const unsigned int last =
        argc == 5 ? Utilities::string_to_int(argv[4]) : 110;
      if (parameters.general.dimension == 2)
        measure<2>(parameters, first, last);
      else
        measure<3>(parameters, first, last);
    }
  catch (const std::exception &exception)
    {
      std::cerr << exception.what() << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 1);
    }
  return 0;
}

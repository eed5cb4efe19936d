// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks that settings without another test have an effect. Checks the
// hydrostatic column against the published errors of CB-Geo MPM.
#include <greville/run/run.h>

#include "simulation.h"

void
test_main()
{
  // The critical step is estimated again while the body moves over the grid.
  const auto critical_steps = [](const unsigned int every) {
    Simulated<2>     run(block_2d("ball(0.3, 0.5, 0.2)", 10)
                       .with("Body body", {"Velocity = 1; 0.3"})
                       .with("Time",
                             {"End = 1",
                                  "Maximum steps = 20",
                                  "Step = 2e-3",
                                  "Too large step = warn"}),
                     [every](SimulationParameters &parameters) {
                       parameters.time.estimate_every = every;
                     });
    std::set<double> values;
    while (!run->is_finished())
      {
        run->step();
        values.insert(run->state().estimates.critical);
      }
    return values.size();
  };
  check("the first estimate only", critical_steps(0) == 1);
  // Estimates that hardly change are made less often: steps 0, 5, and 15.
  check("an estimate every 5 steps", critical_steps(5) == 3);

  // Clipping
  {
    Simulated<2> run(block_2d("box(0.5, 0.5, 3, 3)", 4)
                       .with("Body body", {"Clip at the grid = true"}));
    check("Clip at the grid", std::abs(run->statistics().mass - 0.25), 1e-12);
  }

  // Solver
  const Text full =
    block_2d("box(0, 0, 1, 1)", 6)
      .with("Body body", {"Velocity = x^2; 0", "Points per direction = 3"})
      .with("Scheme", {"Mass = consistent"})
      .with("Solver", {"Method = cg"})
      .with("Time", {"End = 4e-3", "Step = 1e-3"});
  {
    std::string message;
    try
      {
        SimulationParameters parameters  = full.parse();
        parameters.solver.max_iterations = 2;
        Simulation<2>(parameters).step();
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    check("Maximum iterations",
          message.find("did not converge in 2 iterations") !=
            std::string::npos);
  }
  const auto iterations = [&](const std::string &tolerance) {
    Simulated<2> run(full.with("Solver", {"Tolerance = " + tolerance}));
    run->step();
    return run->state().n_iterations;
  };
  check("Tolerance", iterations("1e-12") > iterations("1e-4"));

  // The folder of a run
  {
    const bool first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    if (first)
      {
        // A folder called output would be in the way of the test's own.
        std::filesystem::create_directories("elsewhere");
        std::ofstream("elsewhere/named.prm")
          << full.with("Simulation", {"Name = renamed"}).content;
      }
    MPI_Barrier(MPI_COMM_WORLD);
    std::filesystem::current_path("elsewhere");
    std::streambuf *const buffer = std::cout.rdbuf(nullptr);
    run_simulations("named.prm", MPI_COMM_WORLD);
    MPI_Barrier(MPI_COMM_WORLD);
    std::cout.rdbuf(buffer);
    std::cout.clear();
    std::cout.width(0);
    std::filesystem::current_path("..");
    check("Name",
          std::filesystem::exists("elsewhere/output/renamed/summary.json"));
  }

  // Stress at rest: largest error of any point below the published error of
  // the base pressure at the same h.
  const std::pair<unsigned int, double> published[] = {{12, 0.0485},
                                                       {24, 0.0233},
                                                       {48, 0.0108}};
  for (const auto &size : published)
    {
      SimulationParameters parameters(
        std::string(SOURCE_DIR) +
        "/../../prm/simulation/hydrostatic_column.prm");
      parameters.grid.cells = {1, size.first};
      Simulation<2> column(parameters);
      while (!column.is_finished())
        column.step();
      const double t = column.state().time;
      check("hydrostatic, " + std::to_string(size.first) +
              " cells: relative to the published error",
            ExactSolution<2>(parameters.exact)
                .errors(column.bodies(), t, t, MPI_COMM_WORLD)
                .stress->max /
              size.second,
            0.5);
    }
}

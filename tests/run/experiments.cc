// SPDX-License-Identifier: LGPL-2.1-or-later
// All: 1
// Debug: no

// Checks channel flow against the exact solution, water at rest, and grid
// crossing.
#include <greville/run/simulation_run.h>

#include "simulation.h"

template <int dim>
RunSummary
run(const std::string &name, const std::vector<unsigned int> &cells)
{
  SimulationParameters parameters(std::string(SOURCE_DIR) +
                                  "/../../prm/simulation/" + name + ".prm");
  parameters.grid.cells          = cells;
  parameters.output.fields_every = 0.;
  parameters.output.grid_fields  = false;
  const std::string directory    = name + "_results";
  if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::filesystem::create_directories(directory);
  MPI_Barrier(MPI_COMM_WORLD);
  std::ostream nowhere(nullptr);
  return SimulationRun<dim>(parameters, directory, nowhere, MPI_COMM_WORLD)
    .run();
}



void
test_main()
{
  const RunSummary channel = run<2>("channel_flow", {16, 16});
  check("channel: velocity", channel.errors.velocity->l2, 0.001);
  check("channel: largest error", channel.errors.velocity->max, 0.001);

  // Water that has come to rest in a closed box has its volume, and few of its
  // points bear none of its weight.
  Simulated<2> water(
    Text()
      .add("Simulation", {"Bodies = water", "Materials = water"})
      .add("Grid", {"Upper corner = 0.28575, 0.142875", "Cells = 32, 16"})
      .add("Time", {"End = 3", "CFL number = 0.4"})
      .add("Scheme",
           {"Mass = lumped", "Stress update = MUSL", "FLIP share = 0.975"})
      .add("Body water",
           {"Material = water",
            "Shape = box(0, 0, 0.05715, 0.1143)",
            "Points per direction = 3"})
      .add("Material water", {"Model = newtonian-fluid", "Sound speed = 10"})
      .add("Walls",
           {"Left = sliding",
            "Right = sliding",
            "Bottom = fixed",
            "Top = sliding"})
      .add("Loads", {"Gravity = 0; -9.81"}));
  water.run();
  double n = 0., n_without = 0., volume0 = 0., volume = 0.;
  for (const auto &body : water->bodies())
    {
      body.points.for_each([&](const unsigned int, const auto q) {
        const double V0 = q.volume0(), V = q.volume();
        const double p = -0.5 * (q.stress(0) + q.stress(1));
        ++n;
        n_without += p <= 0.;
        volume0 += V0;
        volume += V;
      });
    }
  check("water at rest: its volume", std::abs(volume / volume0 - 1.), 0.01);
  check("water at rest: part of the points without pressure",
        n_without / n,
        0.2);

  // Large amplitude: with p = 1 the stress jumps where points cross cells, with
  // p >= 2 it does not.
  const auto roughness = [](const unsigned int p) {
    Simulated<2> bar(block_2d("box(0, 0, 25, 1)")
                       .with("Grid",
                             {"Upper corner = 25, 1",
                              "Cells = 16, 1",
                              "Order = " + std::to_string(p)})
                       .with("Material solid", {"Poisson ratio = 0"})
                       .with("Walls",
                             {"Left = sliding",
                              "Right = sliding",
                              "Bottom = sliding",
                              "Top = sliding"})
                       .with("Body body",
                             {"Points per direction = 4",
                              "Velocity = 2 * sin(pi * x / 25); 0"})
                       .with("Time", {"End = 1.25", "CFL number = 0.1"}));
    bar.run();
    // Stress against that of the smallest distance behind it.
    std::map<double, double> stress;
    for (const auto &body : bar->bodies())
      {
        body.points.for_each([&](const unsigned int, const auto q) {
          stress[q.reference(0)] = q.stress(0);
        });
      }
    double jump = 0., largest = 0., last = stress.begin()->second;
    for (const auto &entry : stress)
      {
        jump    = std::max(jump, std::abs(entry.second - last));
        largest = std::max(largest, std::abs(entry.second));
        last    = entry.second;
      }
    return jump / largest;
  };
  const double linear = roughness(1), quadratic = roughness(2),
               cubic = roughness(3);
  check("grid crossing: p = 1 jumps", linear > 0.3);
  check("grid crossing: p = 2 does not", quadratic, 0.5 * linear);
  check("grid crossing: p = 3 does not", cubic, 0.5 * linear);
}

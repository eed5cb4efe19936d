// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2
// Debug: no

// Checks the exact mass matrix at free surfaces: colliding disks conserve
// energy and momentum; the cycle with all orders agrees with the solver of all
// components; a bar breaks.
#include "simulation.h"

void
test_main()
{
  const auto disks = [](const unsigned int p, const std::string &end) {
    return Text()
      .add("Simulation", {"Bodies = lower, upper", "Materials = rubber"})
      .add("Grid", {"Cells = 20, 20", "Order = " + std::to_string(p)})
      .add("Time", {"End = " + end, "CFL number = 0.2"})
      .add("Scheme", {"Mass = consistent", "Stress update = MUSL"})
      .add("Body lower",
           {"Material = rubber",
            "Shape = ball(0.2, 0.2, 0.2)",
            "Points per direction = 3",
            "Velocity = 0.1; 0.1"})
      .add("Body upper",
           {"Material = rubber",
            "Shape = ball(0.8, 0.8, 0.2)",
            "Points per direction = 3",
            "Velocity = -0.1; -0.1"})
      .add("Material rubber",
           {"Model = neo-hookean",
            "Density = 1000",
            "Young modulus = 1000",
            "Poisson ratio = 0.3"});
  };

  for (const unsigned int p : {2, 3})
    {
      Simulated<2> run(disks(p, "3.5"));
      const auto   start = run->statistics();
      run.run();
      const auto end = run->statistics();
      print() << "Disks, p = " << p << std::endl;
      check("  energy changes by less than 2 %",
            std::abs((end.kinetic + end.strain) / start.kinetic - 1.),
            0.02);
      check("  they have bounced", end.kinetic > 0.8 * start.kinetic);
      // The momentum of one of them is about 18 kg m / s.
      for (unsigned int d = 0; d < 2; ++d)
        check("  momentum", std::abs(end.momentum[d]) / 18., 1e-12);
      check("  factorizations are reused",
            run->mass().n_factorizations() < run->state().n_steps);
    }

  // The same by the cycle over all orders.
  {
    const Text   text = disks(2, "1.7").with("Time", {"Step = 0.005"});
    Simulated<2> all(text.with("Solver", {"Tolerance = 1e-12"}));
    all.run();
    Simulated<2> levels(
      text.with("Solver", {"Tolerance = 1e-12", "Method = cg-p-multigrid"}));
    levels.run();
    check("solver by levels",
          std::abs(levels->statistics().strain / all->statistics().strain - 1.),
          1e-6);
  }

  // A bar breaks into two pieces and fragments.
  {
    const SimulationParameters parameters(
      std::string(SOURCE_DIR) + "/../../prm/simulation/breaking_bar.prm");
    Simulation<2> bar(parameters, MPI_COMM_WORLD);
    while (!bar.is_finished())
      bar.step();
    print() << "Breaking bar" << std::endl;
    const auto end = bar.statistics();
    // That of one half is 75 kg m / s in the beginning.
    for (unsigned int d = 0; d < 2; ++d)
      check("  momentum", std::abs(end.momentum[d]) / 75., 1e-12);
    double gap[2] = {-4., 4.}; // between the innermost points of both pieces
    for (const auto &body : bar.bodies())
      body.points.for_each([&](const unsigned int, const auto p) {
        double &side = gap[p.position(0) > 2.];
        side         = p.position(0) > 2. ? std::min(side, p.position(0))
                                          : std::max(side, p.position(0));
      });
    check("  pieces are apart",
          Utilities::MPI::min(gap[1], MPI_COMM_WORLD) -
              Utilities::MPI::max(gap[0], MPI_COMM_WORLD) >
            0.2);
    check("  there are fragments", end.fragments > 0);
    check("  it yields", end.dissipation > 10.);
  }
}

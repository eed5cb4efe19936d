// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2 4

// Every solver of the consistent mass matrix gives the same steps: on a sliding
// floor and on a floor with friction, in each order of a step.

#include "simulation.h"

namespace
{
  std::array<double, 2>
  energies(const Text &text)
  {
    const Statistics<2> row = Simulated<2>(text).run()->statistics();
    return {{row.kinetic, row.strain}};
  }
} // namespace



void
test_main()
{
  const Text block =
    block_2d("box(0.27, 0.005, 0.7, 0.34)", 12)
      .with("Body body", {"Points per direction = 3", "Velocity = 1; -1"})
      .with("Scheme", {"Mass = consistent"})
      .with("Solver", {"Tolerance = 1e-10"})
      .with("Loads", {"Gravity = 0; -10"})
      .with("Time", {"End = 1", "Maximum steps = 30"});
  const std::vector<std::pair<std::string, Text>> cases = {
    {"sliding", block.with("Walls", {"Bottom = sliding"})},
    {"friction",
     block.with("Walls", {"Bottom = friction", "Bottom friction = 0.3"})}};
  for (const auto &entry : cases)
    for (const std::string order : {"USL", "MUSL"})
      {
        const Text text =
          entry.second.with("Scheme", {"Stress update = " + order});
        const auto expected = energies(text);
        check(entry.first + ", " + order + ": the floor is met",
              expected[1] > 1e-3 * expected[0]);
        for (const std::string method : {"cg-p-multigrid", "cg-jacobi", "cg"})
          {
            const auto found =
              energies(text.with("Solver", {"Method = " + method}));
            for (unsigned int k = 0; k < 2; ++k)
              check(entry.first + ", " + order + ", " + method,
                    std::abs(found[k] / expected[k] - 1.),
                    1e-6);
          }
      }
}

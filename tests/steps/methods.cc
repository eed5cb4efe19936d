// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2 4

// Checks that all solvers of the consistent mass matrix yield the same steps on
// a sliding floor, in each order of a step.

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
      .with("Walls", {"Bottom = sliding"})
      .with("Time", {"End = 1", "Maximum steps = 30"});
  for (const std::string order : {"USL", "MUSL"})
    {
      const Text text     = block.with("Scheme", {"Stress update = " + order});
      const auto expected = energies(text);
      check(order + ": the floor is met", expected[1] > 1e-3 * expected[0]);
      for (const std::string method : {"cg-p-multigrid", "cg-jacobi", "cg"})
        {
          const auto found =
            energies(text.with("Solver", {"Method = " + method}));
          for (unsigned int k = 0; k < 2; ++k)
            check(order + ", " + method,
                  std::abs(found[k] / expected[k] - 1.),
                  1e-6);
        }
    }
}

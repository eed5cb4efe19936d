// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 3 4
// Debug: no

// Checks a body that is smaller than the grid part of a process and flies
// through it, so that processes have none of its points and functions for many
// steps: runs end, and conserve momentum.
#include "simulation.h"

void
test_main()
{
  const Text ball = block_2d("ball(0.2, 0.5, 0.15)", 16)
                      .with("Body body", {"Velocity = 1; 0"})
                      .with("Material solid",
                            {"Model = neo-hookean",
                             "Density = 1000",
                             "Young modulus = 1e4",
                             "Poisson ratio = 0.3"})
                      .with("Time", {"End = 0.6"});
  const auto fly = [](const std::string &name, const Text &text) {
    Simulated<2> run(text);
    const auto   start = run->statistics();
    run.run();
    const auto end = run->statistics();
    check(name + ", momentum",
          (end.momentum - start.momentum).norm() / start.momentum.norm(),
          1e-10);
    check(name + ", moves on",
          std::abs(end.center[0] - start.center[0] - 0.6),
          1e-6);
  };
  for (const std::string mass : {"consistent", "lumped", "fmpm-2"})
    fly(mass, ball.with("Scheme", {"Mass = " + mass}));
  fly("MUSL",
      ball.with("Scheme", {"Mass = consistent", "Stress update = MUSL"}));
}

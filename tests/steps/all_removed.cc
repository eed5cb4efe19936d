// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3 4

// Checks that the run ends by itself when the last point of a body has left the
// grid.
#include "simulation.h"

void
test_main()
{
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      Simulated<2> run(
        block_2d("ball(0.7, 0.5, 0.15)", 16)
          .with("Scheme", {"Mass = " + mass, "Points outside = remove"})
          .with("Body body", {"Velocity = 10; 3"})
          .with("Time", {"End = 1"}));
      run.run();
      check(mass + ": ends when the last point has left",
            run->state().time > 0.04 && run->state().time < 0.05);
      check(mass + ": all points are removed",
            run->state().n_removed == run->bodies()[0].n_points &&
              run->statistics().n_points == 0);
      check(mass + ": it says so", run->step_log().take_warnings().size() == 1);
    }
}

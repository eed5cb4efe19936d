// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks some hundred steps of a vibrating beam and of a pile at rest: the mass
// does not change, and nothing grows from step to step. scripts/tables
// long_runs takes 100000 steps.
#include <greville/base/memory.h>

#include "simulation.h"

void
test(const std::string &name, const Text &text, const unsigned int n_steps)
{
  Simulated<2> run(text);
  const auto   start = run->statistics();
  // Lists and factorizations have their sizes by then.
  while (run->state().n_steps < n_steps / 2)
    run->step();
  const auto before = allocated_memory();
  while (run->state().n_steps < n_steps)
    {
      run->step();
      run->statistics();
    }
  const auto after = allocated_memory();
  const auto end   = run->statistics();
  check(name + ", mass", end.mass == start.mass);
  check(name + ", points", end.n_points == start.n_points);
  const auto energy = [](const Statistics<2> &s) {
    return s.kinetic + s.strain + s.gravitational;
  };
  check(name + ", energy", energy(end) / energy(start), 1.02);
  // Half a number for each point and step would be seen.
  if (before && after)
    check(name + ", memory",
          double(*after) - double(*before),
          4. * double(start.n_points) * (n_steps / 2));
}



void
test_main()
{
  const Text beam =
    block_2d("box(0, 0.25, 0.75, 0.5)", 8)
      .with("Body body",
            {"Points per direction = 3", "Velocity = 0; 0.5 * x^2"})
      .with("Walls", {"Left = fixed"})
      .with("Time", {"End = 100"});
  test("lumped", beam.with("Scheme", {"Stress update = MUSL"}), 400);
  test("consistent", beam.with("Scheme", {"Mass = consistent"}), 400);
  test("total Lagrangian",
       beam.with("Scheme",
                 {"Mass = consistent", "Formulation = total Lagrangian"}),
       400);
  test("newmark",
       beam.with("Scheme", {"Mass = consistent", "Stress update = newmark"})
         .with("Time", {"Step = 0.005"}),
       160);
  test("pile",
       block_2d("intersection(box(0, 0, 1, 0.3), half_space(1, 1, 0.9))", 8)
         .with("Body body", {"Points per direction = 3"})
         .with("Material solid",
               {"Model = drucker-prager",
                "Young modulus = 1000",
                "Friction angle = 35",
                "Cohesion = 0.2"})
         .with("Walls", {"Left = sliding", "Bottom = fixed"})
         .with("Loads", {"Gravity = 0; -10", "Cundall damping = 0.7"})
         .with("Scheme", {"Stress update = MUSL", "FLIP share = 0.975"})
         .with("Time", {"End = 100"}),
       600);
}

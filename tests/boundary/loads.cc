// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks loads and damping.
#include "simulation.h"

void
test_main()
{
  const Text block = block_2d("box(0.25, 0.25, 0.75, 0.75)")
                       .with("Time", {"End = 0.1", "Step = 0.005"});
  const auto momentum = [](const Text &text) {
    Simulated<2> run(text);
    run.run();
    // Velocities at half steps: half a step of force is missing.
    const auto s = run->statistics();
    return std::make_pair(s.momentum, s.mass);
  };

  // A ramp of gravity: the sum of g(t_n) dt, with half of the first step.
  {
    const auto P =
      momentum(block.with("Loads", {"Gravity = 0; -min(1, t / 0.05)"}));
    double sum = 0.;
    for (unsigned int n = 0; n < 20; ++n)
      sum -= std::min(1., 0.005 * n / 0.05) * (n == 0 ? 0.0025 : 0.005);
    check("gravity with a ramp",
          std::abs(P.first[1] / P.second / sum - 1.),
          1e-10);
  }
  // Body forces of x, X and t.
  {
    const auto P =
      momentum(block.with("Loads", {"Body force = 1 + (X > 0.5); 2 * t"}));
    check("body force of X",
          std::abs(P.first[0] / P.second / 0.14625 - 1.),
          1e-10);
    const auto Q = momentum(block.with("Loads", {"Body force = y < 0.5; 0"}));
    check("body force of x",
          std::abs(Q.first[0] / Q.second / 0.04875 - 1.),
          0.05);
  }
  // Damping brings a column to rest, at half of its largest deflection.
  const Text column =
    block_2d("box(0, 0, 1, 1)", 4)
      .with("Walls", {"Left = sliding", "Right = sliding", "Bottom = sliding"})
      .with("Loads", {"Gravity = 0; -0.1"})
      .with("Time", {"End = 3", "CFL number = 0.4"})
      .with("Material solid", {"Poisson ratio = 0"})
      .with("Exact solution", {"Displacement = 0; -0.001 * (Y - Y^2 / 2)"});
  const auto kinetic_and_error =
    [&](const std::vector<std::string> &lines,
        const std::vector<std::string> &time = {}) {
      Simulated<2> run(column.with("Loads", lines).with("Time", time));
      run.run();
      return std::make_pair(run->statistics().kinetic,
                            run.displacement_error().l2);
    };
  const auto free = kinetic_and_error({}, {"End = 0.1"});
  check("without damping it moves", free.first > 1e-6);
  const auto cundall = kinetic_and_error({"Cundall damping = 0.5"});
  check("Cundall damping: rest", cundall.first / free.first, 1e-4);
  check("Cundall damping: settlement", cundall.second, 0.02);
  // Any mass: a block that slides on a base that holds it comes to rest, and
  // its energy never grows, at automatic steps.
  for (const std::string mass : {"lumped", "fmpm-4", "consistent"})
    for (const std::string factor : {"0.3", "0.5", "0.8"})
      {
        Simulated<2> run(
          block_2d("box(0.25, 0, 0.75, 0.5)", 12)
            .with("Scheme", {"Mass = " + mass})
            .with("Walls", {"Bottom = fixed"})
            .with("Loads", {"Gravity = 0; -10", "Cundall damping = " + factor})
            .with(
              "Material solid",
              {"Model = neo-hookean", "Density = 1000", "Young modulus = 1e5"})
            .with("Body body", {"Points per direction = 3", "Velocity = 1; 0"})
            .with("Time", {"End = 0.7"}));
        const double start  = run->statistics().kinetic;
        double       lowest = 1e300, rise = 0.;
        while (!run->is_finished())
          {
            run->step();
            const auto   s     = run->statistics();
            const double total = s.kinetic + s.strain + s.gravitational;
            lowest             = std::min(lowest, total);
            rise               = std::max(rise, total - lowest);
          }
        const std::string name = mass + ", Cundall damping " + factor;
        check(name + ": energy", rise / start, 0.05);
        check(name + ": rest", run->statistics().kinetic / start, 0.05);
      }
  // PIC takes energy away, FLIP does not: relative to that of the settlement.
  const auto loss = [&](const std::vector<std::string> &scheme) {
    Simulated<2> run(column.with("Scheme", scheme).with("Time", {"End = 1"}));
    const auto   start = run->statistics();
    run.run();
    const auto end = run->statistics();
    return (start.gravitational + start.strain + start.kinetic -
            end.gravitational - end.strain - end.kinetic) /
           (0.01 / 600.);
  };
  const double flip = loss({});
  check("FLIP keeps the energy", std::abs(flip), 0.25);
  check("PIC damps", loss({"Transfer = PIC"}) > 0.7);
  check("FLIP share", loss({"FLIP share = 0.5"}) > 0.5);
}

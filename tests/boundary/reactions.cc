// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks wall forces in explicit and implicit steps: the change of momentum
// equals the impulse of walls and gravity, and walls bear a weight.
#include "simulation.h"

/// The largest part of a step's change of momentum that forces do not explain,
/// over the largest change.
template <int dim>
double
unexplained(const Text &text, const unsigned int n_steps)
{
  Simulated<dim> run(text);
  Tensor<1, dim> before = run->statistics().momentum;
  double         worst = 0., largest = 0.;
  for (unsigned int k = 0; k < n_steps; ++k)
    {
      run->step();
      const auto     row    = run->statistics();
      Tensor<1, dim> change = row.momentum - before, known;
      known[0] = 0.3 * row.mass, known[1] = -row.mass;
      for (const auto &force : row.reactions)
        known += force;
      worst =
        std::max(worst, (change - run->state().velocity_step * known).norm());
      largest = std::max(largest, change.norm());
      before  = row.momentum;
    }
  return worst / largest;
}



/// A body that is cut by cells, and slides, falls and turns at all kinds of
/// walls.
Text
moving_body(const std::vector<std::string> &scheme,
            const std::string              &right = "friction")
{
  const bool has_friction = right == "friction";
  return block_2d("box(0, 0, 0.93, 1)")
    .with("Body body",
          {"Velocity = 1 - 2 * y; x - 1.2", "Points per direction = 3"})
    .with("Scheme", scheme)
    .with("Loads", {"Gravity = 0.3; -1"})
    .with("Walls",
          {"Left = sliding",
           "Right = " + right,
           has_friction ? "Right friction = 0.3" : "Right friction = 0",
           "Bottom = fixed",
           "Top = moving",
           "Top velocity = 0.2 + t; 0"})
    .with("Solver", {"Tolerance = 1e-14"})
    .with("Time", {"End = 1"});
}



/// The force of the floor after a column has come to rest, over its weight.
double
weight(const std::vector<std::string> &scheme, const std::string &damping)
{
  Simulated<2> run(
    block_2d("box(0, 0, 0.5, 0.9)")
      .with("Scheme", scheme)
      .with("Material solid", {"Poisson ratio = 0"})
      .with("Walls", {"Left = sliding", "Bottom = fixed"})
      .with("Loads", {"Gravity = 0; -0.01", "Cundall damping = " + damping})
      .with("Time", {"End = 2"}));
  run.run();
  const auto row = run->statistics();
  return row.reactions[2][1] / (0.01 * row.mass);
}



void
test_main()
{
  for (const std::string mass : {"lumped", "fmpm-3", "consistent"})
    for (const std::string order : {"USL", "MUSL"})
      for (const std::string transfer : {"FLIP share = 1",
                                         "FLIP share = 0.8",
                                         "Transfer = PIC",
                                         "Transfer = APIC"})
        if (mass == "lumped" || transfer != "Transfer = APIC")
          check(mass + ", " + order + ", " + transfer,
                unexplained<2>(moving_body({"Mass = " + mass,
                                            "Stress update = " + order,
                                            transfer},
                                           mass == "consistent" ? "sliding"
                                                                : "friction"),
                               5),
                1e-11);
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      check(mass + ", total Lagrangian",
            unexplained<2>(moving_body({"Mass = " + mass,
                                        "Formulation = total Lagrangian"},
                                       "sliding"),
                           5),
            1e-11);
      check(mass + ", weight",
            std::abs(weight({"Mass = " + mass}, "0.5") - 1.),
            5e-3);
    }
}

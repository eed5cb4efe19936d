// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// Debug: no

// Checks convergence orders against exact solutions of bars (benchmarks A1 to
// A4, A7).
#include "simulation.h"

Text
bar(const double length)
{
  return block_2d("box(0, 0, " + std::to_string(length) + ", 1)")
    .with("Grid",
          {"Upper corner = " + std::to_string(length) + ", 1", "Cells = 8, 1"})
    .with("Material solid", {"Poisson ratio = 0"})
    .with("Walls", {"Left = sliding", "Bottom = sliding", "Top = sliding"})
    .with("Body body", {"Points per direction = 4", "Placement = Gauss"});
}

double
error_of(const Text        &text,
         const unsigned int p,
         const std::string &mass,
         const unsigned int n,
         const bool         is_square = false)
{
  Simulated<2> run(text
                     .with("Grid",
                           {"Order = " + std::to_string(p),
                            "Cells = " + std::to_string(n) + ", " +
                              std::to_string(is_square ? n : 1)})
                     .with("Scheme", {"Mass = " + mass}));
  return run.run().displacement_error().l2;
}

void
check_order(const std::string &name,
            const Text        &text,
            const unsigned int p,
            const std::string &mass,
            const unsigned int n,
            const double       wanted,
            const bool         is_square = false)
{
  const double coarse = error_of(text, p, mass, n, is_square);
  const double fine   = error_of(text, p, mass, 2 * n, is_square);
  const double order  = std::log2(coarse / fine);
  check(name + ", " + mass + ", p = " + std::to_string(p) +
          ": order at least " + std::to_string(wanted).substr(0, 3),
        order >= wanted - 0.2);
  if (order < wanted - 0.2)
    print() << coarse << ' ' << fine << std::endl;
}



void
test_main()
{
  // A1 and A2. The step follows h^2, so that its error does not matter.
  const Text fixed =
    bar(25)
      .with("Walls", {"Right = sliding"})
      .with("Time", {"End = 0.4", "Step = 0.008 * (h / 3)^2"})
      .with("Body body", {"Velocity = 1e-5 * sin(pi * x / 25); 0"})
      .with("Exact solution",
            {"Displacement = 1e-5 / (0.4 * pi) * sin(0.4 * pi * t) * "
             "sin(pi * X / 25); 0"});
  const Text open =
    bar(25)
      .with("Time", {"End = 0.4", "Step = 0.008 * (h / 3)^2"})
      .with("Body body", {"Velocity = 1e-5 * sin(pi * x / 50); 0"})
      .with("Exact solution",
            {"Displacement = 1e-5 / (0.2 * pi) * sin(0.2 * pi * t) * "
             "sin(pi * X / 50); 0"});
  for (const unsigned int p : {1, 2, 3})
    {
      check_order("both ends fixed", fixed, p, "consistent", 6, p + 1.);
      check_order("one end fixed", open, p, "consistent", 6, p + 1.);
    }
  // The time steps of MUSL are of second order, too.
  const Text musl = fixed.with("Scheme", {"Stress update = MUSL"});
  for (const unsigned int p : {2, 3})
    check_order("both ends fixed, MUSL", musl, p, "consistent", 6, p + 1.);
  // In a larger grid, whose cells the free lateral surfaces cut.
  const Text free =
    fixed.with("Grid", {"Lower corner = 0, -12.5", "Upper corner = 25, 12.5"})
      .with("Body body", {"Shape = box(0, -6, 25, 6.6)"})
      .with("Walls", {"Bottom = free", "Top = free"});
  for (const unsigned int p : {1, 2, 3})
    check_order("free surfaces", free, p, "consistent", 8, p + 1., true);
  check_order("both ends fixed", fixed, 2, "lumped", 12, 2.);
  check_order("both ends fixed", fixed, 2, "fmpm-3", 6, 2.);
  check("consistent mass is worth a factor of 100",
        error_of(fixed, 3, "lumped", 12) >
          100. * error_of(fixed, 3, "consistent", 12));
  for (const std::string method : {"cg", "cg-jacobi", "cg-p-multigrid"})
    check("solver " + method,
          std::abs(error_of(fixed.with("Solver", {"Method = " + method}),
                            2,
                            "consistent",
                            6) /
                     error_of(fixed, 2, "consistent", 6) -
                   1.),
          1e-3);

  // A3: a column that gets its weight at once, over the time in which the wave
  // runs through it (d'Alembert's solution), lying along x.
  const Text column =
    bar(25)
      .with("Material solid", {"Young modulus = 5e4"})
      .with("Loads", {"Gravity = -1e-2; 0"})
      .with("Time", {"End = 0.1", "Step = 0.05 * h / 223.6067977"})
      .with("Exact solution",
            {"Displacement = -0.5e-2 * (t^2 - (X < 223.6067977 * t ? (t - X / "
             "223.6067977)^2 : 0)); 0"});
  for (const unsigned int p : {1, 2, 3})
    check_order("sudden weight", column, p, "consistent", 16, 1.5);

  // A4: a step of traction on the free end runs in with speed 1.
  const Text step =
    bar(1)
      .with("Simulation", {"Surface loads = pull"})
      .with("Grid", {"Upper corner = 1.25, 1"})
      .with("Body body", {"Placement = fitted"})
      .with("Material solid", {"Density = 100"})
      .with("Time", {"End = 0.5", "Step = 0.05 * h"})
      .with("Surface load pull",
            {"Body = body", "Where = x > 0.999", "Traction = 0.01; 0"})
      .with("Exact solution", {"Displacement = 1e-4 * max(0, X - (1 - t)); 0"});
  for (const unsigned int p : {1, 2, 3})
    {
      const double error = error_of(step, p, "consistent", 40);
      check("step of traction, p = " + std::to_string(p), error, 0.03);
    }

  // A7: manufactured solution of Steffen, 2 points per cell in x, and Uintah's
  // published errors (reference/mms1d_anchor.csv), which are absolute.
  const Text mms =
    bar(1)
      .with("Walls", {"Right = sliding"})
      .with("Material solid", {"Model = neo-hookean"})
      .with("Body body",
            {"Points per direction = 2, 4",
             "Placement = equidistant",
             "Displacement = 0.001 * sin(2 * pi * x); 0"})
      .with(
        "Loads",
        {"Body force = 100 * pi^2 * 0.001 * sin(2 * pi * X) * cos(10 * pi * "
         "t) * (1 + 2 / (1 + 0.002 * pi * cos(2 * pi * X) * cos(10 * pi * "
         "t))^2); 0"})
      .with("Time", {"End = 0.1", "Step = 0.1 * h / 10"})
      .with("Exact solution",
            {"Displacement = 0.001 * sin(2 * pi * X) * cos(10 * pi * t); 0"});
  const double                          norm        = 0.001 / std::sqrt(2.);
  const std::pair<unsigned int, double> published[] = {{30, 9.978e-6},
                                                       {62, 4.664e-6},
                                                       {86, 3.332e-6}};
  for (const auto &size : published)
    check(std::to_string(size.first) +
            " cells, relative to the published error",
          norm * error_of(mms, 2, "consistent", size.first) / size.second,
          0.5);
  check_order("manufactured", mms, 2, "consistent", 16, 2.);
}

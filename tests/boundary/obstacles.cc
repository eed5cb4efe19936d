// SPDX-License-Identifier: LGPL-2.1-or-later

// Bodies with an imposed velocity: they hold others up, let go, hold water, and
// work as pistons.
#include "simulation.h"

namespace
{
  // The sum of a function of free points over all processes.
  template <typename Function>
  double
  sum_of_points(Simulated<2> &run, const Function &function)
  {
    double sum = 0.;
    for (const auto &body : run->bodies())
      if (!body.rigid_motion)
        body.points.for_each(
          [&](const unsigned int, const auto p) { sum += function(p); });
    return Utilities::MPI::sum(sum, MPI_COMM_WORLD);
  }

  double
  mean_settlement(Simulated<2> &run)
  {
    return sum_of_points(run,
                         [](const auto p) {
                           return p.mass() * (p.reference(1) - p.position(1));
                         }) /
           sum_of_points(run, [](const auto p) { return p.mass(); });
  }
} // namespace



void
test_main()
{
  // A block on a floor, h = 0.125: under its weight it settles by
  // rho g H^2 / (3 E) in the mean.
  const Text block = block_2d("box(0.25, 0.25, 0.75, 0.75)")
                       .with("Simulation", {"Bodies = body, floor"})
                       .with("Body floor",
                             {"Material = solid",
                              "Shape = box(0, 0, 1, 0.25)",
                              "Imposed velocity = 0; 0"})
                       .with("Material solid", {"Poisson ratio = 0"});
  const Text heavy =
    block.with("Time", {"End = 2"})
      .with("Loads", {"Gravity = 0; -10", "Cundall damping = 0.3"});
  const double settlement = 10. * 0.25 / 300.;
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    for (const std::string order : {"USL", "USF", "MUSL"})
      {
        Simulated<2> run(
          heavy.with("Scheme", {"Mass = " + mass, "Stress update = " + order}));
        const auto total = [&]() {
          const auto s = run->statistics();
          return s.kinetic + s.strain + s.gravitational;
        };
        const double start = total();
        double       gain  = 0.;
        while (!run->is_finished())
          {
            run->step();
            gain = std::max(gain, total() - start);
          }
        const std::string name = mass + ", " + order + ": ";
        check(name + "settlement",
              std::abs(mean_settlement(run) - settlement),
              0.0125 * 0.2);
        check(name + "rest",
              run->statistics().largest_speed,
              0.02 * std::sqrt(2. * 10. * settlement));
        check(name + "no energy from nothing",
              gain,
              0.05 * run->statistics().strain);
      }

  // A block that is thrown up leaves the floor, with hardly any loss.
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      Simulated<2> run(block.with("Scheme", {"Mass = " + mass})
                         .with("Body body", {"Velocity = 0; 0.5"})
                         .with("Time", {"End = 0.3"}));
      run.run();
      check(mass + ": a block leaves the floor",
            std::abs(mean_settlement(run) + 0.15),
            0.0015);
    }

  // Water at rest beside a ramp, in which it has no surface along the cells.
  const Text pool =
    Text()
      .add("Simulation",
           {"Bodies = water, ramp", "Materials = water, concrete"})
      .add("Grid",
           {"Lower corner = 0, 0", "Upper corner = 2, 0.6", "Cells = 40, 12"})
      .add("Time", {"End = 0.1"})
      .add("Body water",
           {"Material = water",
            "Shape = difference(box(0, 0, 2, 0.4), half_space(0.8, 0.6, 0.64))",
            "K0 = 1",
            "Surface = 0.4"})
      .add("Body ramp",
           {"Material = concrete",
            "Shape = intersection(box(0, 0, 0.8, 0.6), half_space(0.8, 0.6, "
            "0.64))",
            "Imposed velocity = 0; 0"})
      .add("Material water", {"Model = newtonian-fluid", "Sound speed = 30"})
      .add("Material concrete",
           {"Model = linear-elastic", "Density = 2000", "Young modulus = 2e6"})
      .add("Walls", {"Left = sliding", "Right = sliding", "Bottom = sliding"})
      .add("Loads", {"Gravity = 0; -9.81"});
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      Simulated<2> run(pool.with("Scheme", {"Mass = " + mass}));
      run.run();
      check(mass + ": still water, relative to the speed of waves",
            run->statistics().largest_speed / 30.,
            1e-3);
    }

  // A piston that moves 0.4 m in a closed chamber leaves 0.6 m of 1 m.
  const Text chamber =
    block_2d("box(0.25, 0, 1.25, 0.25)")
      .with("Simulation", {"Bodies = body, piston"})
      .with("Grid", {"Upper corner = 1.25, 0.25", "Cells = 20, 4"})
      .with("Material solid", {"Model = neo-hookean", "Poisson ratio = 0"})
      .with("Body piston",
            {"Material = solid",
             "Shape = box(0, 0, 0.25, 0.25)",
             "Imposed velocity = 1; 0"})
      .with("Walls", {"Right = sliding", "Bottom = sliding", "Top = sliding"})
      .with("Time", {"End = 0.4"});
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      Simulated<2> run(chamber.with("Scheme", {"Mass = " + mass}));
      run.run();
      const double volume =
        sum_of_points(run, [](const auto p) { return p.volume0() * p.J(); });
      const double behind = sum_of_points(run, [](const auto p) {
        return double(p.position(0) < 0.65 - 0.00625);
      });
      check(mass + ": volume that the piston leaves",
            std::abs(volume / 0.15 - 1.),
            0.05);
      check(mass + ": points behind the piston", behind, 0.);
    }
}

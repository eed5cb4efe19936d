// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks friction walls: Coulomb's law for the total impulses of a sliding
// block, rest below the friction angle, separation, walls that meet, and no
// motion into a wall.
#include "simulation.h"

namespace
{
  template <int dim>
  Tensor<1, dim>
  momentum(Simulated<dim> &run)
  {
    return run->statistics().momentum;
  }

  // The largest coefficient of the velocity of the grid into a lower wall.
  template <int dim>
  double
  into_wall(Simulated<dim> &run, const unsigned int d)
  {
    const auto &space = run->space();
    double      worst = 0.;
    for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
      if (space.on_side(i, 2 * d))
        worst =
          std::max(worst, -run->state().field.velocity[d].local_element(i));
    return max_all(worst);
  }
} // namespace



void
test_main()
{
  // Its sides cut cells.
  const Text block =
    block_2d("box(0.27, 0, 0.71, 0.31)", 12)
      .with("Material solid", {"Young modulus = 1e3"})
      .with("Loads", {"Gravity = 0; -1"})
      .with("Body body", {"Points per direction = 3"})
      .with("Walls", {"Bottom = friction", "Bottom friction = 0.3"});

  for (const std::string mass : {"lumped", "fmpm-2"})
    for (const unsigned int p : {2, 3})
      {
        Simulated<2> run(
          block.with("Scheme", {"Mass = " + mass})
            .with("Grid", {"Order = " + std::to_string(p)})
            .with("Body body", {"Velocity = 0.4; 0"})
            .with("Time", {"End = 0.2", "Velocities at = full steps"}));
        const auto   start = momentum(run);
        const double m     = run->statistics().mass;
        double       worst = 0.;
        while (!run->is_finished())
          {
            run->step();
            worst = std::max(worst, into_wall(run, 1));
          }
        const auto        change = momentum(run) - start;
        const double      push   = change[1] + m * run->state().time;
        const std::string name   = mass + ", p = " + std::to_string(p);
        check(name + ", weight is borne", push / (m * run->state().time) > 0.8);
        check(name + ", Coulomb's law while it slides",
              std::abs(change[0] + 0.3 * push) / push,
              1e-7);
        check(name + ", nothing goes into the wall", worst, 1e-8);
      }

  // On a slope, below and above the angle of friction (0.3).
  for (const double slope : {0.2, 0.5})
    {
      Simulated<2> run(
        block.with("Loads", {"Gravity = " + std::to_string(slope) + "; -1"})
          .with("Time", {"End = 0.3"}));
      const double v = momentum(run.run())[0] / run->statistics().mass;
      if (slope < 0.3)
        check("slope below the angle: rest", std::abs(v), 0.004);
      else
        check("slope above the angle: speed",
              std::abs(v / ((slope - 0.3) * run->state().time) - 1.),
              0.05);
    }

  // A body that flies away is not held back.
  {
    Simulated<2> run(block.with("Loads", {"Gravity = 0; 0"})
                       .with("Body body", {"Velocity = 0.3; 0.2"})
                       .with("Time", {"End = 0.1"}));
    const auto   start = momentum(run);
    run.run();
    check("separation", (momentum(run) - start).norm() / start.norm(), 1e-10);
  }

  // In 3D, across the grid, with a wall that meets the floor.
  {
    Simulated<3> run(
      block_3d("box(0, 0, 0.27, 0.71, 0.31, 0.71)", 4)
        .with("Material solid", {"Young modulus = 1e3"})
        .with("Loads", {"Gravity = -0.5; -1; 0"})
        .with("Body body", {"Velocity = 0; 0; 0.3", "Points per direction = 3"})
        .with("Walls",
              {"Bottom = friction",
               "Bottom friction = 0.3",
               "Left = friction",
               "Left friction = 0.2"})
        .with("Time", {"End = 0.06"}));
    const auto   start = momentum(run);
    const double m     = run->statistics().mass;
    double       worst = 0.;
    while (!run->is_finished())
      {
        run->step();
        worst = std::max({worst, into_wall(run, 0), into_wall(run, 1)});
      }
    const auto change = momentum(run) - start;
    check("3D, nothing goes into the walls", worst, 1e-7);
    check("3D, friction along the walls",
          -change[2] / (m * run->state().time) > 0.2 &&
            -change[2] / (m * run->state().time) < 0.41);
  }
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks walls: their constraints, moving walls, Coulomb friction.
#include "simulation.h"

template <int dim>
Tensor<1, dim>
mean_velocity(Simulated<dim> &run)
{
  const auto s = run->statistics();
  return s.momentum / s.mass;
}



void
test_main()
{
  // A block that fills the grid and moves along a wall: sliding walls let it,
  // fixed ones do not, free ones do not touch it.
  const Text block = block_2d("box(0, 0, 1, 1)", 4)
                       .with("Body body", {"Velocity = 0.01; 0"})
                       .with("Time", {"End = 0.02", "Step = 0.002"});
  for (const std::string mass : {"lumped", "consistent"})
    {
      const auto velocity = [&](const std::string &bottom) {
        Simulated<2> run(
          block.with("Walls", {"Bottom = " + bottom, "Bottom friction = 0"})
            .with("Scheme", {"Mass = " + mass}));
        return mean_velocity(run.run())[0] / 0.01;
      };
      check(mass + ", free", std::abs(velocity("free") - 1.), 1e-10);
      check(mass + ", sliding", std::abs(velocity("sliding") - 1.), 1e-10);
      check(mass + ", fixed", velocity("fixed"), 0.98);
      if (mass == "lumped")
        check("friction without force is sliding",
              std::abs(velocity("friction") - 1.),
              1e-10);
    }

  // Between a fixed and a moving wall: in the end a linear velocity. Viscous
  // fluid, u = y, after the time 1 >> rho L^2 / mu.
  for (const std::string mass : {"lumped", "consistent"})
    {
      Simulated<2> run(block_2d("box(0, 0, 1, 1)", 4)
                         .with("Grid", {"Upper corner = 4, 1", "Cells = 2, 4"})
                         .with("Body body", {"Shape = box(0, 0, 4, 1)"})
                         .with("Material solid", {"Young modulus = 100"})
                         .with("Walls",
                               {"Bottom = fixed",
                                "Top = moving",
                                "Top velocity = 0.01 * min(1, t / 0.05); 0",
                                "Left = sliding",
                                "Right = sliding"})
                         .with("Scheme", {"Mass = " + mass})
                         .with("Time", {"End = 0.1", "Step = 0.001"}));
      run.run();
      const auto &space = run->space();
      double      worst = 0.;
      for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
        if (space.on_side(i, 3) && !space.on_side(i, 0) && !space.on_side(i, 1))
          worst =
            std::max(worst,
                     std::abs(run->state().field.velocity[0].local_element(i) -
                              0.01));
      check(mass + ", velocity at the moving wall", max_all(worst), 1e-12);
    }

  // A body that moves with its walls keeps its velocity.
  for (const std::string mass : {"lumped", "fmpm-2", "fmpm-4", "consistent"})
    {
      Simulated<2> run(block_2d("box(0.25, 0, 0.75, 1)")
                         .with("Grid", {"Upper corner = 2, 1", "Cells = 16, 8"})
                         .with("Body body", {"Velocity = 1; 0"})
                         .with("Walls",
                               {"Bottom = moving",
                                "Bottom velocity = 1; 0",
                                "Top = moving",
                                "Top velocity = 1; 0"})
                         .with("Scheme", {"Mass = " + mass})
                         .with("Time", {"End = 0.05"}));
      run.run();
      const auto s = run->statistics();
      check(mass + ", moves with its walls: speed", s.largest_speed, 1. + 1e-6);
      check(mass + ", moves with its walls: momentum",
            std::abs(s.momentum[0] / s.mass - 1.),
            1e-6);
    }

  // A block that is stopped by its fixed floor: damped, all of its points come
  // to rest, those that hardly any free function sees, too.
  for (const std::string mass : {"lumped", "fmpm-2", "consistent"})
    {
      Simulated<2> run(block_2d("box(0.25, 0, 0.75, 0.5)")
                         .with("Body body", {"Velocity = 0.1; 0"})
                         .with("Loads", {"Cundall damping = 0.3"})
                         .with("Walls", {"Bottom = fixed"})
                         .with("Scheme", {"Mass = " + mass})
                         .with("Time", {"End = 3"}));
      const double start = run->statistics().kinetic;
      run.run();
      const auto end = run->statistics();
      check(mass + ", fixed floor: speed of points at rest",
            end.largest_speed,
            0.002);
      check(mass + ", fixed floor: no energy from nothing",
            end.kinetic + end.strain,
            0.01 * start);
    }

  // A wall that speeds up: at half steps it has the velocity of that time.
  for (const std::string at : {"half steps", "full steps"})
    {
      Simulated<2> run(
        block_2d("box(0, 0, 1, 1)", 4)
          .with("Walls", {"Top = moving", "Top velocity = t; 0"})
          .with("Time",
                {"End = 0.02", "Step = 0.002", "Velocities at = " + at}));
      run.run();
      const double wanted = at == "half steps" ? 0.019 : 0.02;
      check("wall that speeds up, " + at,
            std::abs(run->state().field.velocity[0].linfty_norm() - wanted),
            1e-12);
    }

  // A stiff block slides on a friction wall under gravity: v = v0 - mu g t
  // until it stops.
  const Text sliding =
    block_2d("box(0.25, 0, 0.75, 0.25)", 16)
      .with("Material solid", {"Young modulus = 1e4"})
      .with("Loads", {"Gravity = 0; -1"})
      .with("Body body", {"Velocity = 0.2; 0", "K0 = 0", "Surface = 0.25"})
      .with("Walls", {"Bottom = friction", "Bottom friction = 0.4"})
      .with("Time", {"End = 0.25", "CFL number = 0.3"});
  Simulated<2> half(sliding);
  half.run();
  check("friction: mean velocity after half of the way to rest",
        std::abs(mean_velocity(half)[0] - 0.1),
        0.01);
  Simulated<2> all(sliding.with("Time", {"End = 0.7"}));
  check("friction: rest", std::abs(mean_velocity(all.run())[0]), 0.01);

  // In 3D each wall has its name.
  for (const std::string wall :
       {"Left", "Right", "Bottom", "Top", "Back", "Front"})
    {
      const bool first = wall == "Left" || wall == "Bottom" || wall == "Back";
      const unsigned int d = (wall == "Left" || wall == "Right")   ? 0
                             : (wall == "Bottom" || wall == "Top") ? 1
                                                                   : 2;
      std::string        velocity;
      for (unsigned int k = 0; k < 3; ++k)
        velocity += std::string(k > 0 ? "; " : "") +
                    (k == d ? (first ? "-0.01" : "0.01") : "0");
      Simulated<3> run(block_3d("box(0, 0, 0, 1, 1, 1)", 2)
                         .with("Body body", {"Velocity = " + velocity})
                         .with("Walls", {wall + " = sliding"})
                         .with("Time", {"End = 0.02", "Step = 0.005"}));
      const double v = mean_velocity(run.run())[d] / (first ? -0.01 : 0.01);
      check("3D, " + wall + " stops what comes", v > 0.3 && v < 0.97);
    }
}

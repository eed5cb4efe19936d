// SPDX-License-Identifier: LGPL-2.1-or-later

// Implicit and quasi-static steps: free fall, orders in time, conservation of
// energy and momentum, equilibrium, and steps that are cut.
#include "simulation.h"

namespace
{
  const std::vector<std::string> second_order = {"newmark",
                                                 "generalized-alpha",
                                                 "implicit-midpoint"};



  template <int dim>
  void
  check_free_fall(const Text &block, const std::string &scheme)
  {
    Simulated<dim> fall(
      block.with("Scheme", {"Mass = consistent", "Stress update = " + scheme})
        .with("Loads", {dim == 2 ? "Gravity = 0; -10" : "Gravity = 0; 0; -10"})
        .with("Time", {"End = 0.2", "Step = 0.05"}));
    const double start = fall->statistics().center[dim - 1];
    fall.run();
    const Statistics<dim> row = fall->statistics();
    check(scheme + " in " + std::to_string(dim) + "D: free fall",
          std::abs(start - row.center[dim - 1] - 0.2) < 1e-9 &&
            row.strain < 1e-12 * row.kinetic);
  }



  /**
   * The error of a bar in its first mode, with large steps in time.
   */
  double
  bar_error(const std::string &scheme, const double step)
  {
    return Simulated<2>(
             block_2d("box(0, 0, 25, 1)")
               .with("Grid",
                     {"Upper corner = 25, 1", "Cells = 8, 1", "Order = 3"})
               .with("Material solid", {"Poissons ratio = 0"})
               .with("Scheme",
                     {"Mass = consistent", "Stress update = " + scheme})
               .with("Walls",
                     {"Left = sliding",
                      "Right = sliding",
                      "Bottom = sliding",
                      "Top = sliding"})
               .with("Body body",
                     {"Points per direction = 4",
                      "Placement = Gauss",
                      "Velocity = 1e-5 * sin(pi * x / 25); 0"})
               .with("Time", {"End = 2", "Step = " + std::to_string(step)})
               .with("Exact solution",
                     {"Displacement = 1e-5 / (0.4 * pi) * sin(0.4 * pi * t) * "
                      "sin(pi * X / 25); 0"}))
      .run()
      .displacement_error()
      .l2;
  }



  void
  check_order_in_time(const std::string &scheme, const double wanted)
  {
    const double order =
      std::log2(bar_error(scheme, 0.1) / bar_error(scheme, 0.05));
    check(scheme + ": order " + std::to_string(int(wanted)) + " in time",
          order > wanted - 0.15 && order < wanted + 1.);
    if (!(order > wanted - 0.15 && order < wanted + 1.))
      print() << order << std::endl;
  }



  /**
   * A column under its own weight, confined, nu = 0: the stress of all points
   * is known. What is left is the error of sums over points that have moved,
   * which falls with the order and the number of points.
   */
  double
  column_error(const std::string &model, const unsigned int p)
  {
    return Simulated<2>(
             block_2d("box(0, 0, 1, 8)")
               .with("Grid",
                     {"Upper corner = 1, 9",
                      "Cells = 1, 18",
                      "Order = " + std::to_string(p)})
               .with("Body body",
                     {"Points per direction = 4", "Placement = Gauss"})
               .with("Material solid",
                     {"Model = " + model,
                      "Youngs modulus = 10000",
                      "Poissons ratio = 0"})
               .with("Scheme",
                     {"Mass = consistent", "Stress update = quasi-static"})
               .with("Walls",
                     {"Left = sliding", "Right = sliding", "Bottom = fixed"})
               .with("Loads", {"Gravity = 0; -20 * t"})
               .with("Time", {"End = 1", "Step = 0.1"})
               .with("Exact solution", {"Stress = 0; -20 * (8 - Y) * t; 0; 0"}))
      .run()
      .stress_error()
      .l2;
  }



  /**
   * What a run ends with.
   */
  std::string
  message_of_run(const Text &text)
  {
    try
      {
        Simulated<2>(text).run();
      }
    catch (const std::exception &error)
      {
        return message_of(error);
      }
    return "";
  }



  void
  check_message(const std::string &name,
                const Text        &text,
                const std::string &wanted)
  {
    const std::string message = message_of_run(text);
    check(name, message.find(wanted) != std::string::npos);
    if (message.find(wanted) == std::string::npos)
      print() << message << std::endl;
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  for (const std::string &scheme : second_order)
    {
      check_free_fall<2>(block_2d("box(0.31, 0.4, 0.72, 0.9)", 12), scheme);
      check_free_fall<3>(block_3d("box(0.31, 0.2, 0.4, 0.72, 0.7, 0.9)", 6),
                         scheme);
      check_order_in_time(scheme, 2.);
    }
  check_order_in_time("backward-euler", 1.);

  // A disk that spins and is compressed, with steps of 3 h / c.
  Simulated<2> spin(
    block_2d("ball(0.5, 0.5, 0.3)", 16)
      .with("Scheme",
            {"Mass = consistent", "Stress update = implicit-midpoint"})
      .with("Body body",
            {"Points per direction = 3",
             "Velocity = -3 * (y - 0.5) + 0.1; 3 * (x - 0.5) - (y - 0.5)"})
      .with("Newton", {"Tolerance = 1e-11"})
      .with("Time", {"End = 0.5", "Step = 0.02"}));
  const Statistics<2> before = spin->statistics();
  spin.run();
  const Statistics<2> after = spin->statistics();
  const double        start = before.kinetic + before.strain;
  check("implicit-midpoint keeps energy",
        std::abs(after.kinetic + after.strain - start) < 1e-9 * start);
  if (!(std::abs(after.kinetic + after.strain - start) < 1e-9 * start))
    print() << (after.kinetic + after.strain) / start - 1. << std::endl;
  check("and momentum",
        std::abs(after.momentum[0] - before.momentum[0]) +
            std::abs(after.momentum[1] - before.momentum[1]) <
          1e-10);

  for (const std::string model : {"linear-elastic", "neo-hookean"})
    for (const unsigned int p : {2, 3})
      {
        const double error = column_error(model, p),
                     most  = p == 2 ? 4e-3 : 4e-4;
        check("column of " + model + ", p = " + std::to_string(p),
              error < most);
        if (!(error < most))
          print() << error << std::endl;
      }

  const Text at_rest =
    block_2d("box(0.25, 0, 0.75, 0.5)")
      .with("Scheme", {"Mass = consistent", "Stress update = quasi-static"})
      .with("Walls", {"Bottom = fixed"})
      .with("Loads", {"Gravity = 0; -10 * t"})
      .with("Time", {"End = 1", "Step = 0.5"});

  // Steps that are too long for Newton's method are cut.
  Simulated<2> cut(
    at_rest.with("Loads", {"Gravity = 0; -100 * t"})
      .with("Newton", {"Maximum iterations = 3", "Tolerance = 1e-10"}));
  cut.run();
  check("steps are cut",
        cut->state().n_steps > 2 && cut->state().n_steps < 100);
  check("the summary knows the functions",
        cut->consistent_mass()->extension().counts().stable > 0 &&
          cut->statistics().active > 0);
  check_message("too many steps",
                at_rest.with("Time", {"Step = 1e-12"}),
                "'Time/Maximum steps'");
  check_message("where the residual is",
                at_rest.with("Newton", {"Maximum iterations = 1"})
                  .with("Implicit", {"Smallest step = 0.1"}),
                "the largest residual");
  check_message("no support",
                at_rest.with("Walls", {"Bottom = sliding"}),
                "the body can move freely in x");
  check_message("no step", at_rest.with("Time", {"Step ="}), "'Time/Step'");
  check_message("friction",
                at_rest.with("Walls",
                             {"Bottom = friction", "Bottom friction = 0.3"}),
                "'Walls' = friction");
  check_message("FMPM", at_rest.with("Scheme", {"Mass = fmpm-2"}), "fmpm-2");
  check_message("APIC",
                at_rest.with("Scheme", {"Transfer = APIC", "Mass = lumped"}),
                "APIC");
  check_message("damping",
                at_rest.with("Loads", {"Cundall damping = 0.1"}),
                "damping in 'Loads'");

  // A wall that moves gives the work that goes into the block.
  Simulated<2> pressed(
    block_2d("box(0, 0, 1, 1)")
      .with("Scheme", {"Mass = consistent", "Stress update = quasi-static"})
      .with("Material solid", {"Poissons ratio = 0"})
      .with("Walls",
            {"Left = sliding",
             "Right = sliding",
             "Bottom = fixed",
             "Top = moving",
             "Top velocity = 0; -0.01"})
      .with("Time", {"End = 1", "Step = 0.1"}));
  pressed.run();
  // The wall acts at the edge of the grid: each step strains by 0.001.
  check("a wall presses",
        std::abs(pressed->statistics().strain / 0.005 - 1.) < 2e-3);
}

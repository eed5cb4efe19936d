// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks implicit and quasi-static steps: free fall, orders in time, damping of
// high modes, loads that depend on point positions, conservation of energy and
// momentum, equilibrium, and shortened steps.
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



  /// The error of a bar in its first mode, with large steps in time.
  double
  bar_error(const std::string              &scheme,
            const std::vector<std::string> &constants,
            const double                    step)
  {
    return Simulated<2>(
             block_2d("box(0, 0, 25, 1)")
               .with("Grid",
                     {"Upper corner = 25, 1", "Cells = 8, 1", "Order = 3"})
               .with("Material solid", {"Poisson ratio = 0"})
               .with("Scheme",
                     {"Mass = consistent", "Stress update = " + scheme})
               .with("Implicit", constants)
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
  check_order_in_time(const std::string              &scheme,
                      const std::vector<std::string> &constants,
                      const double                    wanted,
                      const double                    step = 0.1)
  {
    const double order = std::log2(bar_error(scheme, constants, step) /
                                   bar_error(scheme, constants, 0.5 * step));
    check(scheme + (constants.empty() ? "" : ", " + constants[0]) + ": order " +
            std::to_string(int(wanted)) + " in time",
          order > wanted - 0.15 && order < wanted + 1.);
    if (!(order > wanted - 0.15 && order < wanted + 1.))
      print() << order << std::endl;
  }



  /// A bar of one cell in steps of omega dt = 1e4: the velocities of the scheme
  /// of Chung and Hulbert are (a + b n) (-rho)^n, so that v_n + 2 rho v_n-1 +
  /// rho^2 v_n-2 vanishes.
  void
  check_damping(const std::string &formulation, const std::string &rho)
  {
    const double dt = 1e4 / std::sqrt(3. * 100.);
    Simulated<2> run(
      block_2d("box(0, 0, 1, 1)", 1)
        .with("Material solid", {"Poisson ratio = 0"})
        .with("Walls", {"Left = sliding", "Bottom = sliding"})
        .with("Body body", {"Velocity = 1e-4 * x; 0"})
        .with("Scheme",
              {"Mass = consistent",
               "Formulation = " + formulation,
               "Stress update = generalized-alpha"})
        .with("Implicit", {"Spectral radius = " + rho})
        .with("Newton", {"Tolerance = 1e-6", "Absolute tolerance = 1e-12"})
        .with("Time",
              {"Step = " + std::to_string(dt),
               "End = " + std::to_string(10. * dt)}));
    std::vector<double> v    = {run->statistics().momentum[0]};
    const double        r    = std::stod(rho);
    double              left = 0.;
    for (unsigned int n = 1; n <= 6; ++n)
      {
        run->step();
        v.push_back(run->statistics().momentum[0]);
        if (n >= 2)
          left = std::max(
            left, std::abs(v[n] + 2. * r * v[n - 1] + r * r * v[n - 2]) / v[0]);
      }
    check("generalized-alpha, " + formulation + ", rho = " + rho +
            ": amplification",
          left,
          5e-5);
  }



  const std::string total   = "Formulation = total Lagrangian",
                    updated = "Formulation = updated Lagrangian";

  /// A block that a force of x and X on its points moves as a whole, and the
  /// iterations of Newton's method in a step at most.
  void
  check_body_force(const std::string &scheme, const std::string &formulation)
  {
    unsigned int most  = 0;
    const auto   error = [&](const std::string &force,
                           const std::string &u,
                           const std::string &v,
                           const double       step) {
      Simulated<2> run(
        block_2d("box(0.2, 0.2, 0.7, 0.7)", 5)
          .with("Body body", {"Velocity = " + v})
          .with("Scheme",
                {"Mass = consistent", formulation, "Stress update = " + scheme})
          .with("Loads", {"Body force = " + force})
          .with("Newton", {"Tolerance = 1e-9"})
          .with("Time", {"End = 1", "Step = " + std::to_string(step)})
          .with("Exact solution", {"Displacement = " + u}));
      run.run();
      for (const NewtonRecord &record : run->step_log().take_newton())
        most = std::max(most, record.result.n_iterations());
      return run.displacement_error().l2;
    };
    const auto check_order = [&](const std::string &name,
                                 const std::string &force,
                                 const std::string &u,
                                 const std::string &v) {
      most               = 0;
      const double large = error(force, u, v, 0.1),
                   small = error(force, u, v, 0.05),
                   order = std::log2(large / small);
      const std::string text =
        scheme + ", " + formulation + ", " + name + " of x: ";
      check(text + "order 2", order > 1.85 && order < 2.2);
      check(text + "tangent", most <= 3);
      if (!(order > 1.85 && order < 2.2 && most <= 3))
        print() << large << ' ' << small << ' ' << most << std::endl;
    };
    check_order("force",
                "-4 * (x - X); 0",
                "1e-2 / 2 * sin(2 * t); 0",
                "1e-2; 0");
    // Its tangent is not symmetric; d_1 + i d_2 is sinh((1 + 2 i) t) / (1 + 2
    // i).
    check_order("force without a potential",
                "-3 * (x - X) - 4 * (y - Y); 4 * (x - X) - 3 * (y - Y)",
                "2e-3 * (sinh(t) * cos(2 * t) + 2 * cosh(t) * sin(2 * t)); "
                "2e-3 * (cosh(t) * sin(2 * t) - 2 * sinh(t) * cos(2 * t))",
                "1e-2; 0");
  }



  /// Forces of x on points and of y on some of them, to equilibrium: it does
  /// not depend on the number of steps in which they grow.
  template <int dim>
  void
  check_equilibrium()
  {
    const std::string zero = dim == 2 ? "" : "; 0";
    const auto        end  = [&](const std::string &step) {
      Simulated<dim> run(
        (dim == 2 ? block_2d("box(0, 0, 0.5, 0.5)", 5)
                          : block_3d("box(0, 0, 0, 0.5, 0.5, 0.5)", 4))
          .with("Simulation", {"Surface loads = pull"})
          .with("Body body", {"Placement = fitted"})
          .with("Material solid", {"Model = neo-hookean"})
          .with("Scheme",
                {"Mass = consistent", total, "Stress update = quasi-static"})
          .with("Walls", {"Left = sliding", "Bottom = sliding"})
          .with("Walls",
                dim == 2 ? std::vector<std::string>()
                                 : std::vector<std::string>{"Back = sliding"})
          .with("Loads", {"Body force = 60 * t * x; 40 * t * x * y" + zero})
          .with("Surface load pull",
                {"Body = body",
                 "Where = x > 0.499",
                 "Traction = 0; 20 * t * y" + zero})
          .with("Newton", {"Tolerance = 1e-10"})
          .with("Time", {"End = 1", "Step = " + step}));
      run.run();
      return run->statistics();
    };
    const Statistics<dim> one = end("1"), four = end("0.25");
    check("equilibrium with loads of x, energy",
          std::abs(one.strain / four.strain - 1.),
          1e-8);
    check("equilibrium with loads of x, center",
          (one.center - four.center).norm(),
          1e-9);
  }



  /// A block in a potential, m (x - c) . K (x - c) / 2, has the energy that it
  /// had, and so says the balance.
  void
  check_potential(const std::string &formulation)
  {
    Simulated<2> run(
      block_2d("ball(0.45, 0.45, 0.3)", 14)
        .with("Scheme",
              {"Mass = consistent",
               formulation,
               "Stress update = implicit-midpoint"})
        .with("Body body",
              {"Velocity = 0.3 + (y - 0.4); 0.2", "Points per direction = 3"})
        .with("Loads",
              {"Body force = -20 * (x - 0.5) + 5 * (y - 0.4); "
               "5 * (x - 0.5) - 10 * (y - 0.4)"})
        .with("Newton", {"Tolerance = 1e-11"})
        .with("Time", {"End = 0.5", "Step = 0.02"}));
    const auto potential = [&]() {
      double sum = 0.;
      for (const auto &body : run->bodies())
        body.points.for_each([&](const unsigned int, const auto p) {
          const double x = p.position(0) - 0.5, y = p.position(1) - 0.4;
          sum += p.mass() * (10. * x * x - 5. * x * y + 5. * y * y);
        });
      return Utilities::MPI::sum(sum, MPI_COMM_WORLD);
    };
    const Statistics<2> before = run->statistics();
    const double        begin  = potential();
    run.run();
    const Statistics<2> after = run->statistics();
    const double        gained =
      after.kinetic + after.strain - before.kinetic - before.strain;
    check("implicit-midpoint, " + formulation + ": energy in a potential",
          std::abs(gained + potential() - begin) / begin,
          1e-9);
    check("and the work of the potential",
          std::abs(gained - after.work.loads) / begin,
          1e-9);
  }



  /// A column under its own weight, confined, nu = 0: the stress of all points
  /// is known. What is left is the error of sums over points that have moved,
  /// which falls with the order and the number of points.
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
                      "Young modulus = 10000",
                      "Poisson ratio = 0"})
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



  /// The state at the end of a run.
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



void
test_main()
{
  for (const std::string &scheme : second_order)
    {
      check_free_fall<2>(block_2d("box(0.31, 0.4, 0.72, 0.9)", 12), scheme);
      check_free_fall<3>(block_3d("box(0.31, 0.2, 0.4, 0.72, 0.7, 0.9)", 6),
                         scheme);
      check_order_in_time(scheme, {}, 2.);
      for (const std::string &formulation : {updated, total})
        check_body_force(scheme, formulation);
    }
  check_order_in_time("backward-euler", {}, 1.);
  for (const std::string rho : {"0", "0.5", "1"})
    check_order_in_time("generalized-alpha",
                        {"Spectral radius = " + rho},
                        2.,
                        0.05);
  for (const std::string formulation :
       {"updated Lagrangian", "total Lagrangian"})
    for (const std::string rho : {"0", "0.5", "0.8", "1"})
      check_damping(formulation, rho);
  check_equilibrium<2>();
  check_equilibrium<3>();
  check_potential(updated);
  check_potential(total);

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
        cut->mass().counts().stable > 0 && cut->statistics().active > 0);
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
                "'Loads/Cundall damping'");

  // A wall that moves gives the work that goes into the block.
  Simulated<2> pressed(
    block_2d("box(0, 0, 1, 1)")
      .with("Scheme", {"Mass = consistent", "Stress update = quasi-static"})
      .with("Material solid", {"Poisson ratio = 0"})
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

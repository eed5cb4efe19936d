// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks columns of statistics.csv: the work of gravity, loads, walls and
// friction closes the energy balance, the columns of bodies sum up to the
// totals, and repeated steps are counted. With SHOW in the environment, it
// prints the values.

#include "simulation.h"

namespace
{
  const std::string total = "Formulation = total Lagrangian";

  double
  column(const Statistics<2> &row, const std::string &name)
  {
    for (const auto &entry : row.columns())
      if (entry.first == name)
        return entry.second;
    print() << "FAILED: no column " << name << std::endl;
    return std::nan("");
  }

  // The work of all sources, without gravity if it is a potential.
  double
  all_work(const Statistics<2> &row)
  {
    double sum = 0.;
    for (const auto &entry : row.columns())
      if (entry.first.compare(0, 5, "work_") == 0)
        sum += entry.second;
    return sum;
  }



  /// The balance of a run, relative to the work of the source @p main.
  void
  check_balance(const std::string &name,
                const Text        &text,
                const std::string &main,
                const double       tolerance)
  {
    Simulated<2>        run(text);
    const Statistics<2> begin = run->statistics();
    const Statistics<2> end   = run.run()->statistics();
    const double        gain  = end.kinetic + end.strain + end.dissipation -
                        begin.kinetic - begin.strain - begin.dissipation;
    const double work = std::abs(column(end, "work_" + main));
    check(name + ": there is work", work > 1e-12);
    const double open = std::abs(gain - all_work(end)) / work;
    check(name + ": balance", open, tolerance);
    if (std::getenv("SHOW"))
      {
        print() << name << ": open " << open << ", gain " << gain;
        for (const auto &entry : end.columns())
          if (entry.first.compare(0, 5, "work_") == 0)
            print() << ", " << entry.first << ' ' << entry.second;
        print() << ", " << run->state().n_steps << " steps" << std::endl;
      }
  }



  void
  check_sources()
  {
    const Text block = block_2d("box(0.25, 0, 0.75, 0.5)", 8)
                         .with("Scheme", {"Mass = consistent"})
                         .with("Material solid", {"Model = neo-hookean"})
                         .with("Walls", {"Bottom = fixed"});
    const Text in_time = block.with("Time", {"End = 0.3", "Step = 0.002"});
    const auto scheme  = [](const Text &text, const std::string &name) {
      return name == "USL" ? text
                            : text.with("Scheme", {"Stress update = " + name});
    };
    for (const std::string name :
         {"USL", "newmark", "generalized-alpha", "implicit-midpoint"})
      {
        const Text text = scheme(in_time, name);
        check_balance(name + ", gravity",
                      text.with("Loads", {"Gravity = 0; -1"}),
                      "gravity",
                      0.02);
        check_balance(name + ", body force",
                      text.with("Loads", {"Body force = 1 + t; 0"}),
                      "loads",
                      0.02);
        check_balance(name + ", wall",
                      text.with("Walls",
                                {"Bottom = moving", "Bottom velocity = t; 0"}),
                      "walls",
                      0.02);
        check_balance(
          name + ", surfaces",
          text.with("Simulation", {"Surface loads = push, spring"})
            .with("Scheme", {"Formulation = total Lagrangian"})
            .with("Body body", {"Placement = fitted"})
            .with("Surface load push",
                  {"Body = body", "Where = y > 0.499", "Traction = 10 * t; 0"})
            .with("Surface load spring",
                  {"Body = body",
                   "Where = x > 0.749",
                   "Kind = spring",
                   "Stiffness = 100"}),
          "load_push",
          0.02);
      }
    // Loads and walls that grow in ten steps to equilibrium.
    const Text slow = scheme(block, "quasi-static")
                        .with("Scheme", {"Formulation = total Lagrangian"})
                        .with("Time", {"End = 1", "Step = 0.1"});
    check_balance("quasi-static, body force",
                  slow.with("Loads", {"Body force = 3 * t; 0"}),
                  "loads",
                  0.01);
    check_balance(
      "quasi-static, wall",
      slow.with("Walls", {"Top = moving", "Top displacement = 0.05 * t; 0"})
        .with("Body body", {"Shape = box(0.25, 0, 0.75, 1)"}),
      "walls",
      0.01);
    check_balance(
      "quasi-static, surface",
      slow.with("Simulation", {"Surface loads = push"})
        .with("Body body", {"Placement = fitted"})
        .with("Surface load push",
              {"Body = body", "Where = y > 0.499", "Traction = 3 * t; 0"}),
      "load_push",
      0.01);

    check_balance("friction",
                  block.with("Scheme", {"Mass = lumped"})
                    .with("Body body", {"Velocity = 0.4; 0"})
                    .with("Loads", {"Gravity = 0; -1"})
                    .with("Walls",
                          {"Bottom = friction", "Bottom friction = 0.3"})
                    .with("Time", {"End = 0.5"}),
                  "friction",
                  0.1);
  }



  /// Gravity that grows from zero, in explicit steps: with the kinetic energy
  /// at the end of a step the balance is open by an error of second order.
  void
  check_growing_gravity()
  {
    const auto open = [](const std::string &step) {
      Simulated<2> run(block_2d("box(0.25, 0, 0.75, 0.5)", 8)
                         .with("Scheme", {"Mass = consistent", total})
                         .with("Material solid", {"Model = neo-hookean"})
                         .with("Walls", {"Bottom = fixed"})
                         .with("Loads", {"Gravity = 0; -min(1, t / 0.1)"})
                         .with("Time", {"End = 0.128", "Step = " + step}));
      run.run();
      run->finish();
      const Statistics<2> row = run->statistics();
      return (row.kinetic + row.strain - row.work.gravity) / row.work.gravity;
    };
    const double large = open("0.004"), small = open("0.002");
    check("growing gravity: balance", std::abs(small), 2e-3);
    check("growing gravity: order 2", std::abs(large / small) > 3.5);
    if (std::getenv("SHOW"))
      print() << "growing gravity: " << large << ' ' << small << std::endl;
  }



  void
  check_bodies()
  {
    Simulated<2>        run(block_2d("ball(0.3, 0.5, 0.19)", 16)
                       .with("Simulation", {"Bodies = body, other"})
                       .with("Body body", {"Velocity = 1; 0.1"})
                       .with("Body other",
                             {"Material = solid",
                                     "Shape = ball(0.75, 0.5, 0.19)",
                                     "Velocity = -2; 0"})
                       .with("Time", {"End = 0.05"}));
    const Statistics<2> begin = run->statistics();
    check("momentum of a body",
          std::abs(column(begin, "momentum_other_x") /
                     (-2. * 0.19 * 0.19 * numbers::PI) -
                   1.),
          0.05);
    const Statistics<2> end = run.run()->statistics();
    for (const std::string name : {"kinetic", "strain", "dissipation"})
      check("sum of " + name,
            std::abs(column(end, name + "_body") +
                     column(end, name + "_other") - column(end, name)),
            1e-12);
    for (const std::string d : {"_x", "_y"})
      check("sum of momentum" + d,
            std::abs(column(end, "momentum_body" + d) +
                     column(end, "momentum_other" + d) -
                     column(end, "momentum" + d)),
            1e-12);
    check("they meet", column(end, "strain_other") > 1e-4 * end.kinetic);
    const auto names = Statistics<2>::names({}, {"body", "other"});
    check("names", names.size() == end.columns().size());
    check("one body has no columns of its own",
          Statistics<2>::names({}, {"body"}).size() ==
            Statistics<2>::names().size());
  }



  void
  check_redone()
  {
    const Text text = block_2d("box(0.25, 0, 0.75, 0.5)", 8)
                        .with("Material solid", {"Model = neo-hookean"})
                        .with("Walls", {"Bottom = fixed"})
                        .with("Scheme",
                              {"Formulation = total Lagrangian",
                               "Stress update = quasi-static",
                               "Mass = consistent"})
                        .with("Loads", {"Body force = 20 * t; 0"})
                        .with("Time", {"End = 1", "Step = 1"});
    Simulated<2> easy(text.with("Loads", {"Body force = 0.01 * t; 0"}));
    Simulated<2> hard(text.with("Newton", {"Maximum iterations = 3"}));
    check("no step is done again",
          column(easy.run()->statistics(), "redone") == 0.);
    const double redone = column(hard.run()->statistics(), "redone");
    check("cuts of steps are counted", redone >= 1.);
    if (std::getenv("SHOW"))
      print() << redone << " of " << hard->state().n_steps << std::endl;
  }
} // namespace



void
test_main()
{
  check_sources();
  check_growing_gravity();
  check_bodies();
  check_redone();
}

// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks stages: a column that rests after loading, the same bits as without
// stages, released walls, files, and refused input. Also checks walls with a
// given displacement.
#include <greville/run/run.h>

#include "simulation.h"

namespace
{
  std::string
  in_stage(const std::string              &name,
           const std::string              &section,
           const std::vector<std::string> &lines)
  {
    Text text;
    text.add(section, lines);
    return "subsection Stage " + name + "\n" + text.content + "end\n";
  }

  Text
  with_stage(Text                            text,
             const std::string              &name,
             const std::string              &section,
             const std::vector<std::string> &lines)
  {
    text.content += in_stage(name, section, lines);
    return text;
  }



  /// A column that is loaded in the first stage, and free to move afterwards.
  Text
  column(const std::vector<std::string> &scheme)
  {
    const Text text =
      block_2d("box(0, 0, 2, 8)")
        .with("Simulation", {"Stages = load, rest"})
        .with("Grid", {"Upper corner = 2, 9", "Cells = 4, 18"})
        .with("Body body", {"Points per direction = 3"})
        .with("Material solid",
              {"Model = neo-hookean", "Density = 1000", "Young modulus = 1e7"})
        .with("Scheme", {"Mass = consistent"})
        .with("Walls", {"Left = sliding", "Right = sliding", "Bottom = fixed"})
        // The last steps of the first stage have all of the load.
        .with("Loads", {"Gravity = 0; -10 * min(1, 2 * (t + 1))"})
        .with("Time", {"Start = -1"});
    return with_stage(
      with_stage(
        with_stage(with_stage(text, "load", "Time", {"End = 0", "Step = 0.1"}),
                   "load",
                   "Scheme",
                   {"Stress update = quasi-static"}),
        "rest",
        "Scheme",
        scheme),
      "rest",
      "Time",
      {"End = 0.1"});
  }



  void
  check_rest(const std::string &name, const Text &text)
  {
    Simulated<2> simulated(text);
    while (!simulated->is_stage_finished())
      simulated->step();
    const Statistics<2> begin = simulated->statistics();
    double              most  = 0.;
    while (!simulated->is_finished())
      {
        simulated->step();
        most = std::max(most, simulated->statistics().kinetic);
      }
    check(name + ": at rest after a quasi-static stage",
          begin.time == 0. && begin.kinetic == 0. && begin.strain > 1000. &&
            simulated->state().stage == 1 &&
            std::abs(simulated->state().time - 0.1) < 1e-14 &&
            most < 1e-14 * begin.strain);
  }



  /// A block that bounces in a box.
  Text
  block(const std::string &scheme)
  {
    return block_2d("box(0.25, 0.25, 0.75, 0.75)")
      .with("Body body", {"Velocity = 0.5 * x; -1"})
      .with("Scheme", {"Stress update = " + scheme})
      .with("Loads", {"Gravity = 0; -5 * t"})
      .with("Walls", {"Bottom = sliding"})
      .with("Time", {"End = 0.4", "Step = 0.002"});
  }

  Text
  in_two_stages(const Text &text)
  {
    return with_stage(with_stage(text.with("Simulation", {"Stages = one, two"}),
                                 "one",
                                 "Time",
                                 {"End = 0.2"}),
                      "two",
                      "Time",
                      {"End = 0.4"});
  }

  double
  difference(Simulated<2> &a, Simulated<2> &b)
  {
    const auto x = a->statistics().values(), y = b->statistics().values();
    const auto names  = Statistics<2>::names();
    double     result = 0.;
    for (unsigned int k = 0; k < x.size(); ++k)
      if (names[k] != "iterations")
        result =
          std::max(result, std::abs(x[k] - y[k]) / (1. + std::abs(x[k])));
    return result;
  }

  void
  check_no_seam(const std::string              &name,
                const std::vector<std::string> &scheme,
                const std::string              &order)
  {
    const Text text =
      block(order).with("Scheme", scheme).with("Solver", {"Tolerance = 1e-10"});
    Simulated<2> one(text), two(in_two_stages(text));
    one.run();
    two.run();
    check(name + ": two stages do what one does",
          two->state().stage == 1 && two->state().n_steps == 200 &&
            difference(one, two) < 1e-8);
    if (!(difference(one, two) < 1e-8))
      print() << difference(one, two) << std::endl;
  }



  /// Velocities at half steps, and those of the end of a step.
  void
  check_free_fall(const std::string &first, const std::string &second)
  {
    const Text text =
      with_stage(in_two_stages(
                   block_2d("box(0.25, 0.45, 0.75, 0.95)")
                     .with("Scheme",
                           {"Mass = consistent", "Stress update = " + first})
                     .with("Newton", {"Tolerance = 1e-12"})
                     .with("Loads", {"Gravity = 0; -2"})
                     .with("Time", {"End = 0.4", "Step = 0.004"})),
                 "two",
                 "Scheme",
                 {"Stress update = " + second});
    Simulated<2>        fall(text);
    const double        begin = fall->statistics().center[1];
    const Statistics<2> end   = fall.run()->statistics();
    const double        v     = -2. * fall->state().velocity_time;
    check("free fall by " + first + " and " + second,
          std::abs(end.center[1] - begin + 0.16) < 1e-10 &&
            std::abs(end.momentum[1] / end.mass - v) < 1e-10);
  }



  void
  check_going_back()
  {
    Simulated<2> simulated(in_two_stages(block("USL")));
    while (simulated->state().n_steps < 40)
      simulated->step();
    const State<2> early = simulated->state();
    simulated.run();
    const State<2> late = simulated->state();
    simulated->set_state(early);
    check("a state knows its stage",
          simulated->state().stage == 0 && late.stage == 1 &&
            simulated->stage_parameters().time.end == 0.2);
    simulated.run();
    double largest = 0.;
    for (unsigned int d = 0; d < 2; ++d)
      {
        VectorType change = late.field.velocity[d];
        for (unsigned int i = 0; i < change.locally_owned_size(); ++i)
          largest =
            std::max(largest,
                     std::abs(
                       change.local_element(i) -
                       simulated->state().field.velocity[d].local_element(i)));
      }
    check("the same bits after going back over the end of a stage",
          largest == 0. && simulated->state().n_steps == late.n_steps);
  }



  /// Squeezed by a wall, which vanishes; displacements begin anew.
  void
  check_release()
  {
    Text text = block_2d("box(0, 0, 1, 1)", 4)
                  .with("Simulation", {"Stages = squeeze, release"})
                  .with("Scheme", {"Mass = consistent"})
                  .with("Walls", {"Left = sliding", "Bottom = sliding"});
    text = with_stage(text, "squeeze", "Time", {"End = 1", "Step = 0.25"});
    text =
      with_stage(text, "squeeze", "Scheme", {"Stress update = quasi-static"});
    text = with_stage(text,
                      "squeeze",
                      "Walls",
                      {"Right = moving", "Right displacement = -0.01 * t; 0"});
    text = with_stage(text, "release", "Time", {"End = 1.1"});
    text.content +=
      "subsection Stage release\n  set Reset displacements = true\nend\n";
    Simulated<2> simulated(text);
    while (!simulated->is_stage_finished())
      simulated->step();
    const Statistics<2> begin    = simulated->statistics();
    const Body<2>      &body     = simulated->bodies()[0];
    const auto          farthest = [&]() {
      double result = 0.;
      body.points.for_each([&](ConstPointRef<2> p) {
        result = std::max(result, p.position().distance(p.reference()));
      });
      return Utilities::MPI::max(result, MPI_COMM_WORLD);
    };
    const double squeezed = farthest();
    simulated->step();
    const double released = farthest();
    simulated.run();
    const Statistics<2> end = simulated->statistics();
    check("the wall has squeezed", squeezed > 0.008 && begin.strain > 0.);
    check("displacements are counted anew", released < 0.1 * squeezed);
    check("the body comes back with the energy that it had",
          end.kinetic > 0.2 * begin.strain &&
            std::abs(end.kinetic + end.strain - begin.strain) <
              0.01 * begin.strain);
  }



  void
  run_quietly(const Text &text, const std::string &directory)
  {
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      {
        std::filesystem::remove_all(directory);
        std::ofstream("stages.prm")
          << text.with("Output", {"Directory = " + directory}).content;
      }
    MPI_Barrier(MPI_COMM_WORLD);
    std::streambuf *const buffer = std::cout.rdbuf(nullptr);
    run_simulations("stages.prm", MPI_COMM_WORLD);
    std::cout.rdbuf(buffer);
    std::cout.clear();
    std::cout.width(0);
    MPI_Barrier(MPI_COMM_WORLD);
  }

  /// The first and last column of a CSV.
  std::vector<std::pair<double, double>>
  first_and_last(const std::string &file)
  {
    std::ifstream                          in(file);
    std::string                            line;
    std::vector<std::pair<double, double>> result;
    std::getline(in, line);
    while (std::getline(in, line))
      result.emplace_back(std::stod(line),
                          std::stod(line.substr(line.rfind(',') + 1)));
    return result;
  }

  void
  check_files()
  {
    const Text text = column({"Mass = lumped"})
                        .with("Output",
                              {"Fields every = 0.3",
                               "Statistics every = 0.02",
                               "Probes = 1, 4"});
    run_quietly(text, "stages_out");
    const auto rows   = first_and_last("stages_out/statistics.csv");
    const auto probes = first_and_last("stages_out/probes.csv");
    bool       grows  = rows.size() == probes.size() && rows.size() == 16;
    for (unsigned int k = 1; k < rows.size(); ++k)
      grows = grows && rows[k].first > rows[k - 1].first &&
              rows[k].second == (rows[k].first > 0. ? 2. : 1.) &&
              std::abs(rows[k].first - probes[k].first) < 1e-10;
    check("rows of statistics and probes, with their stage",
          grows && rows[0].first == -1. && rows[10].first == 0. &&
            std::abs(rows.back().first - 0.1) < 1e-12);
    std::ifstream     in("stages_out/fields.pvd");
    std::stringstream content;
    content << in.rdbuf();
    const std::string pvd = content.str();
    unsigned int      n   = 0;
    for (auto k = pvd.find("name=\"points\""); k != std::string::npos;
         k      = pvd.find("name=\"points\"", k + 1))
      ++n;
    // -1, -0.7, -0.4, -0.1, the end of the stage, the end
    check("times of fields",
          n == 6 && pvd.find("timestep=\"0\"") != std::string::npos);

    // The parameters of the run give the same run.
    std::ifstream     again("stages_out/parameters.prm");
    std::stringstream used;
    used << again.rdbuf();
    run_quietly(Text(used.str()), "stages_again");
    const auto same = first_and_last("stages_again/statistics.csv");
    check("the parameters that were used run again", same == rows);
  }



  /// Confined compression: each step stretches by 1 - (d' - d) / L, as a wall
  /// holds the edge of the grid.
  void
  check_compression()
  {
    Text text =
      block_2d("box(0, 0, 1, 1)", 1)
        .with("Grid", {"Cells = 4, 1", "Order = 1"})
        .with("Simulation", {"Stages = a, b"})
        .with("Scheme", {"Mass = consistent", "Stress update = quasi-static"})
        .with("Walls",
              {"Left = sliding",
               "Right = sliding",
               "Bottom = fixed",
               "Top = moving",
               "Top displacement = 0; -0.04 * t ^ 2"});
    // Steps of 0.3, 0.3 and 0.4.
    text = with_stage(text, "a", "Time", {"End = 0.6", "Step = 0.3"});
    text = with_stage(text, "b", "Time", {"End = 1", "Step = 0.4"});
    Simulated<2> simulated(text);
    simulated.run();
    double       F   = 1.;
    const double t[] = {0., 0.3, 0.6, 1.};
    for (unsigned int k = 0; k < 3; ++k)
      F *= 1. - 0.04 * (t[k + 1] * t[k + 1] - t[k] * t[k]);
    double worst = 0.;
    simulated->bodies()[0].points.for_each([&](ConstPointRef<2> p) {
      worst = std::max({worst,
                        std::abs(p.position(1) - F * p.reference(1)),
                        std::abs(p.position(0) - p.reference(0)),
                        std::abs(p.J() - F)});
    });
    check("confined compression in three unequal steps",
          simulated->state().n_steps == 3 && worst < 1e-9);
    if (!(worst < 1e-9))
      print() << worst << std::endl;
  }



  /// A single cell of order 1 moves as its walls do.
  void
  check_wall(const std::vector<std::string> &scheme, const std::string &step)
  {
    Text text = block_2d("box(0, 0, 1, 1)", 1)
                  .with("Grid", {"Order = 1"})
                  .with("Scheme", scheme)
                  .with("Time", {"End = 0.7", "Step = " + step});
    for (const std::string wall : {"Left", "Right", "Bottom", "Top"})
      text = text.with("Walls",
                       {wall + " = moving",
                        wall + " displacement = 0.03 * t ^ 3; -0.02 * t"});
    Simulated<2> simulated(text);
    simulated.run();
    double worst = 0.;
    simulated->bodies()[0].points.for_each([&](ConstPointRef<2> p) {
      worst = std::max({worst,
                        std::abs(p.position(0) - p.reference(0) - 0.03 * 0.343),
                        std::abs(p.position(1) - p.reference(1) + 0.02 * 0.7)});
    });
    check(scheme[0] + ", " + scheme[1] + ": a body moves with its walls",
          worst < 1e-12);
    if (!(worst < 1e-12))
      print() << worst << std::endl;
  }
} // namespace



void
test_main()
{
  check_rest("lumped",
             with_stage(column({"Mass = lumped"}),
                        "load",
                        "Scheme",
                        {"Filling threshold = 0"}));
  check_rest("consistent", column({"Stress update = USL"}));
  check_rest("newmark",
             with_stage(column({"Stress update = newmark"}),
                        "rest",
                        "Time",
                        {"Step = 0.02"}));
  check_rest("implicit-midpoint",
             with_stage(column({"Stress update = implicit-midpoint"}),
                        "rest",
                        "Time",
                        {"Step = 0.02"}));

  for (const std::string order : {"USL", "MUSL"})
    {
      check_no_seam(order + ", lumped", {"Mass = lumped"}, order);
      check_no_seam(order + ", consistent", {"Mass = consistent"}, order);
    }
  for (const std::string order : {"implicit-midpoint", "generalized-alpha"})
    check_no_seam(order, {"Mass = consistent"}, order);
  for (const std::string explicit_one : {"USL", "MUSL"})
    {
      check_free_fall(explicit_one, "newmark");
      check_free_fall("generalized-alpha", explicit_one);
    }
  check_free_fall("USL", "MUSL");
  check_going_back();
  check_release();
  check_files();

  const Text good = in_two_stages(block("USL"));
  check_refused("unknown stage",
                good.with("Simulation", {"Stages = one, too"}),
                "'Simulation/Stages' does not name <two>");
  check_refused("stage without section",
                good.with("Simulation", {"Stages = one, two, three"}),
                "there is no section 'Stage three'");
  check_refused("end before the last one",
                with_stage(good, "two", "Time", {"End = 0.1"}),
                "Stage 2 (two): 'Time/End' is 0.1 s, but the stage begins at "
                "0.2 s");
  check_refused("start of a stage",
                with_stage(good, "two", "Time", {"Start = 0.1"}),
                "A stage begins when the stage before ends");
  check_refused("section that all stages share",
                with_stage(good, "two", "Grid", {"Order = 2"}),
                "there is no section 'Stage two/Grid'");
  check_refused("typo in a stage",
                with_stage(good, "two", "Time", {"Ende = 2"}),
                "there is no parameter 'Ende'");
  check_refused("integrator of a later stage",
                with_stage(good,
                           "two",
                           "Scheme",
                           {"Stress update = newmark", "Transfer = APIC"}),
                "Stage 2 (two): ");
  check_refused("start behind the end",
                block("USL").with("Time", {"Start = 3"}),
                "'Time/Start' is 3 s, after 'Time/End'");
  check_refused("velocity and displacement of a wall",
                block("USL").with("Walls",
                                  {"Top = moving",
                                   "Top velocity = 1; 0",
                                   "Top displacement = t; 0"}),
                "both of 'Top velocity'");
  check_refused("displacement of a wall that does not move",
                block("USL").with("Walls", {"Top displacement = t; 0"}),
                "'Top displacement' is <t; 0>");
  check_refused("displacement of a wall along its normal",
                block("USL").with("Walls",
                                  {"Top = moving", "Top displacement = 0; t"}),
                "'Walls/Top displacement' moves the wall along its normal");

  check_compression();
  for (const std::string order : {"USL", "MUSL", "newmark"})
    for (const std::string mass : {"lumped", "consistent"})
      check_wall({"Stress update = " + order, "Mass = " + mass}, "0.007");
}

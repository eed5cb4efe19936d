// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2 4

// Checks bodies with their own grids: they do not interact, take common steps,
// meet the walls of the grid, and bear their loads.
#include <greville/run/run.h>
#include <greville/steps/implicit_scheme.h>

#include "simulation.h"

namespace
{
  /// Simulations with their parameters.
  struct Together
  {
    explicit Together(const Text &text)
      : parameters(text.parse())
      , simulations(parameters)
    {}

    CoupledSimulations<2> &
    run()
    {
      while (!simulations.is_finished())
        simulations.step();
      return simulations;
    }

    SimulationParameters  parameters;
    CoupledSimulations<2> simulations;
  };



  /// Initial position, position, velocity and stress of all points of a body on
  /// all processes, in the order of initial positions.
  std::vector<std::array<double, 8>>
  points_of(const BodyList<2> &bodies, const std::string &name)
  {
    std::vector<double> numbers;
    for (const Body<2> &body : bodies)
      if (body.name == name)
        body.points.for_each([&](const ConstPointRef<2> p) {
          for (unsigned int d = 0; d < 2; ++d)
            numbers.push_back(p.reference(d));
          for (unsigned int d = 0; d < 2; ++d)
            numbers.push_back(p.position(d));
          for (unsigned int d = 0; d < 2; ++d)
            numbers.push_back(p.velocity(d));
          for (const unsigned int k : {0, 3})
            numbers.push_back(p.stress(k));
        });
    std::vector<std::array<double, 8>> result;
    for (const auto &all : Utilities::MPI::all_gather(MPI_COMM_WORLD, numbers))
      for (unsigned int k = 0; k < all.size(); k += 8)
        {
          result.emplace_back();
          std::copy_n(all.begin() + k, 8, result.back().begin());
        }
    std::sort(result.begin(), result.end(), [](const auto &a, const auto &b) {
      return std::abs(a[0] - b[0]) > 1e-9 ? a[0] < b[0] : a[1] < b[1];
    });
    return result;
  }

  /// The largest difference of the points of a body, relative to the largest
  /// number of each kind.
  double
  difference(const BodyList<2> &a,
             const BodyList<2> &b,
             const std::string &name)
  {
    const auto first = points_of(a, name), second = points_of(b, name);
    if (first.size() != second.size() || first.empty())
      return 1e300;
    double result = 0.;
    for (unsigned int kind = 0; kind < 8; kind += 2)
      {
        double most = 0., size = 1e-300;
        for (unsigned int k = 0; k < first.size(); ++k)
          for (unsigned int c = kind; c < kind + 2; ++c)
            {
              most = std::max(most, std::abs(first[k][c] - second[k][c]));
              size = std::max(size, std::abs(second[k][c]));
            }
        result = std::max(result, most / size);
      }
    return result;
  }



  const std::vector<std::string> ball = {"Material = rubber",
                                         "Shape = ball(0.4, 0.45, 0.21)",
                                         "Placement = fitted",
                                         "Points per direction = 4",
                                         "Velocity = 4; 0.5 * x"},
                                 box  = {"Material = rubber",
                                         "Shape = box(0.5, 0.3, 0.85, 0.6)",
                                         "Placement = fitted",
                                         "Velocity = -2 + 2 * y; 0"};

  /// A ball and a box in the same place.
  Text
  ball_and_box(const std::string &scheme, const std::string &mass)
  {
    return Text()
      .add("Simulation", {"Bodies = ball, box", "Materials = rubber"})
      .add("Grid", {"Cells = 16, 16"})
      .add("Scheme",
           {"Formulation = total Lagrangian",
            "Mass = " + mass,
            "Stress update = " + scheme})
      .add("Body ball", ball)
      .add("Body box", box)
      .add("Material rubber",
           {"Model = neo-hookean",
            "Density = 1",
            "Young modulus = 100",
            "Poisson ratio = 0.3"})
      .add("Newton", {"Tolerance = 1e-11"})
      .add("Solver", {"Tolerance = 1e-13"})
      .add("Time",
           {"End = 0.1",
            scheme == "USL" || scheme == "MUSL" ? "Step = 0.001"
                                                : "Step = 0.01"});
  }

  Text
  with_grid(const Text                     &text,
            const std::string              &body,
            const std::vector<std::string> &lines)
  {
    Text result = text;
    result.content += "subsection Body " + body + "\n  subsection Grid\n";
    for (const std::string &line : lines)
      result.content += "    set " + line + "\n";
    result.content += "  end\nend\n";
    return result;
  }



  /// The parameters of one body on the whole of its grid.
  SimulationParameters
  alone(SimulationParameters parameters, const std::string &body)
  {
    parameters.general.bodies = {body};
    parameters.grid           = parameters.grid_of(body);
    parameters.grid.per_body  = false;
    parameters.body_grids.clear();
    return parameters;
  }

  void
  run(Simulation<2> &simulation)
  {
    while (!simulation.is_finished())
      simulation.step();
  }



  /// Bodies in the same place with other cells and orders, which move through
  /// each other, are those that are alone on the whole of their grids.
  void
  check_alone(const std::string &scheme, const std::string &mass)
  {
    const std::string   name = scheme + ", " + mass;
    Together            both(with_grid(with_grid(ball_and_box(scheme, mass),
                                      "ball",
                                      {"Lower corner = 0, 0.1",
                                                  "Upper corner = 0.9, 0.9",
                                                  "Cells = 18, 16",
                                                  "Order = 3"}),
                            "box",
                            {"Cells = 20, 20"}));
    const Statistics<2> begin = both.simulations.statistics();
    both.run();
    check(name + ": grid of the ball is cut out",
          both.simulations.part(0).space().n_dofs() < 21 * 19);

    std::vector<Statistics<2>> parts, begins;
    for (const std::string body : {"ball", "box"})
      {
        Simulation<2> simulation(alone(both.parameters, body));
        begins.push_back(simulation.statistics());
        run(simulation);
        check(name + ": steps of the " + body,
              simulation.state().n_steps ==
                both.simulations.first().state().n_steps);
        check(name + ": points of the " + body,
              difference(both.simulations.bodies(), simulation.bodies(), body),
              mass == "consistent" || is_implicit_scheme(scheme) ? 1e-7 : 1e-9);
        parts.push_back(simulation.statistics());
      }
    const Statistics<2> sums = both.simulations.statistics();
    const auto          close =
      [&](const std::string &what, const double value, const double expected) {
        check(name + ": " + what,
              std::abs(value - expected),
              1e-8 * (std::abs(expected) + 1e-3));
      };
    close("mass", sums.mass, parts[0].mass + parts[1].mass);
    close("kinetic energy", sums.kinetic, parts[0].kinetic + parts[1].kinetic);
    close("strain energy", sums.strain, parts[0].strain + parts[1].strain);
    close("spin",
          sums.angular_momentum[0],
          parts[0].angular_momentum[0] + parts[1].angular_momentum[0]);
    close("front", sums.runout, std::max(parts[0].runout, parts[1].runout));
    close("points", sums.n_points, parts[0].n_points + parts[1].n_points);
    for (unsigned int d = 0; d < 2; ++d)
      {
        close("momentum",
              sums.momentum[d],
              parts[0].momentum[d] + parts[1].momentum[d]);
        close("centre",
              sums.center[d] * sums.mass,
              parts[0].center[d] * parts[0].mass +
                parts[1].center[d] * parts[1].mass);
      }
    check(name + ": momentum stays",
          (sums.momentum - begin.momentum).norm(),
          1e-8 * begin.momentum.norm());
    check(name + ": they have passed each other",
          parts[0].center[0] > parts[1].center[0] + 0.1 &&
            begins[0].center[0] < begins[1].center[0] - 0.1);
  }



  /// The part of the grid around a body gives what all of it gives: walls hold
  /// what they hold, loads are the same.
  void
  check_shared(const std::string &scheme, const std::string &mass)
  {
    const std::string name = scheme + ", " + mass + ", walls";
    const Text        text =
      ball_and_box(scheme, mass)
        .with("Grid", {"Cells = 20, 20", "Order = 2"})
        // One touches the walls at the left, the other one none.
        .with(
          "Body ball",
          {"Shape = intersection(ball(0.11, 0.163, 0.307), box(0, 0, 1, 1))",
           "Velocity = 0; 0"})
        .with("Body box",
              {"Shape = box(0.65, 0.2, 0.95, 0.7)", "Velocity = 0; 0"})
        .with("Walls", {"Left = fixed", "Bottom = sliding", "Top = fixed"})
        .with("Loads", {"Gravity = 0; -20"})
        .with("Simulation", {"Surface loads = wind, gust"})
        .with("Surface load wind",
              {"Body = box", "Kind = pressure", "Pressure = 3"})
        .with("Surface load gust",
              {"Body = ball",
               "Kind = traction",
               "Traction = 0; 2 * t",
               "Where = box(0.2, 0, 1, 1)"});
    Together shared(text), own(text.with("Grid", {"Per body = true"}));
    shared.run();
    own.run();
    check(name + ": one part", shared.simulations.n_parts() == 1);
    check(name + ": two parts", own.simulations.n_parts() == 2);
    for (const std::string body : {"ball", "box"})
      check(name + ": points of the " + body,
            difference(own.simulations.bodies(),
                       shared.simulations.bodies(),
                       body),
            1e-7);
    const Statistics<2> a = own.simulations.statistics(),
                        b = shared.simulations.statistics();
    check(name + ": gravitational energy",
          std::abs(a.gravitational - b.gravitational),
          1e-7 * std::abs(b.gravitational));
    check(name + ": names of loads",
          a.loads[0].first == "wind" && a.loads[1].first == "gust");
    for (unsigned int k = 0; k < 2; ++k)
      check(name + ": loads",
            (a.loads[k].second - b.loads[k].second).norm(),
            1e-7 * (1e-2 + b.loads[k].second.norm()));
    for (unsigned int w = 0; w < 4; ++w)
      check(name + ": reactions",
            (a.reactions[w] - b.reactions[w]).norm(),
            1e-6 * (1e-2 + b.reactions[w].norm()));
    const auto &parts = own.simulations;
    check(name + ": walls of the ball",
          parts.part(0).stage_parameters().walls.type[0] == "fixed" &&
            parts.part(0).stage_parameters().walls.type[2] == "sliding" &&
            parts.part(0).stage_parameters().walls.type[3] == "free");
    check(name + ": walls of the box",
          parts.part(1).stage_parameters().walls.type[0] == "free" &&
            parts.part(1).stage_parameters().walls.type[3] == "free");
  }



  /// The shortest step of all counts; a step that one of them rejects is tried
  /// again by all.
  void
  check_steps()
  {
    // The box is stiffer, and sets the automatic steps.
    const Text automatic = ball_and_box("USL", "consistent")
                             .with("Grid", {"Per body = true"})
                             .with("Simulation", {"Materials = rubber, steel"})
                             .with("Body box", {"Material = steel"})
                             .with("Material steel",
                                   {"Model = neo-hookean",
                                    "Density = 1",
                                    "Young modulus = 400",
                                    "Poisson ratio = 0.3"})
                             .with("Time", {"End = 0.05", "Step ="});
    Together both(automatic);
    both.run();
    const auto run_alone = [](const Together &together, const auto &body) {
      SimulationParameters parameters = together.parameters;
      parameters.general.bodies       = {body};
      auto simulations = std::make_unique<CoupledSimulations<2>>(parameters);
      while (!simulations->is_finished())
        simulations->step();
      return simulations;
    };
    const auto box_alone  = run_alone(both, "box");
    const auto ball_alone = run_alone(both, "ball");
    check("automatic steps: the stiffer body sets them",
          both.simulations.first().state().n_steps ==
              box_alone->first().state().n_steps &&
            ball_alone->first().state().n_steps <
              box_alone->first().state().n_steps);
    check("automatic steps: points of the stiffer body",
          difference(both.simulations.bodies(), box_alone->bodies(), "box"),
          1e-12);

    // Newton's method of the ball needs shorter steps than the given one.
    const Text given = ball_and_box("newmark", "consistent")
                         .with("Grid", {"Per body = true"})
                         .with("Time", {"Step = 0.1", "End = 0.2"})
                         .with("Newton", {"Maximum iterations = 5"})
                         .with("Body box", {"Velocity = 0; 0"})
                         .with("Body ball", {"Velocity = 8 * y; -12 * x"});
    Together      rejecting(given);
    Simulation<2> rejected(alone(rejecting.parameters, "ball"));
    rejecting.run();
    run(rejected);
    const State<2> &state = rejecting.simulations.first().state();
    check("rejected steps", state.n_steps > 2);
    check("rejected steps: number",
          state.n_steps == rejected.state().n_steps &&
            state.n_steps == rejecting.simulations.part(1).state().n_steps);
    check("rejected steps: points of the ball",
          difference(rejecting.simulations.bodies(), rejected.bodies(), "ball"),
          1e-7);
    check("rejected steps: same time",
          state.time == rejecting.simulations.part(1).state().time);
  }



  /// A state is a value, and one that fails takes all back.
  void
  check_states()
  {
    Together both(
      ball_and_box("USL", "lumped").with("Grid", {"Per body = true"}));
    CoupledSimulations<2> &simulations = both.simulations;
    simulations.step();
    const std::vector<State<2>> states         = simulations.state();
    const auto                  run_five_steps = [&]() {
      for (unsigned int k = 0; k < 5; ++k)
        simulations.step();
      auto numbers = points_of(simulations.bodies(), "ball");
      for (const auto &row : points_of(simulations.bodies(), "box"))
        numbers.push_back(row);
      return numbers;
    };
    const auto first = run_five_steps();
    simulations.set_state(states);
    check("a state to go back to: the same bits", run_five_steps() == first);

    // A body that is turned inside out.
    const unsigned int n_good = simulations.first().state().n_steps;
    simulations.set_state(simulations.state());
    for (Body<2> &body : simulations.part(1).bodies())
      body.points.for_each(
        [](PointRef<2> p) { p.velocity(0) = -1e5 * p.position(0); });
    std::string message;
    try
      {
        simulations.step();
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    check("failure: the body",
          message.find("Step 7 of 'Body box'") != std::string::npos);
    if (message.find("Step 7 of 'Body box'") == std::string::npos)
      print() << message << std::endl;
    for (unsigned int k = 0; k < 2; ++k)
      check("failure: all go back",
            simulations.part(k).state().n_steps == n_good);
  }



  /// Stages: a ball that is released by a wall.
  void
  check_stages()
  {
    const auto stage = [](const std::string &name,
                          const std::string &end,
                          const std::string &wall,
                          const std::string &scheme) {
      return "subsection Stage " + name +
             "\n  subsection Time\n    set End = " + end +
             "\n  end\n  subsection Walls\n    set Left = " + wall +
             "\n  end\n  subsection Scheme\n    set Stress update = " + scheme +
             "\n  end\nend\n";
    };
    Text text =
      ball_and_box("newmark", "consistent")
        .with("Body ball", {"Shape = box(0, 0.3, 0.4, 0.6)", "Velocity = x; 0"})
        .with("Body box", {"Shape = box(0.6, 0.3, 0.85, 0.6)"})
        .with("Grid", {"Cells = 20, 20"})
        .with("Simulation", {"Stages = held, free"});
    text.content += stage("held", "0.1", "fixed", "newmark") +
                    stage("free", "0.2", "free", "implicit-midpoint");
    Together shared(text), own(text.with("Grid", {"Per body = true"}));
    shared.run();
    own.run();
    check("stages: the last one", own.simulations.part(1).state().stage == 1);
    for (const std::string body : {"ball", "box"})
      check("stages: points of the " + body,
            difference(own.simulations.bodies(),
                       shared.simulations.bodies(),
                       body),
            1e-7);
  }



  void
  check_files()
  {
    const Text text =
      with_grid(ball_and_box("USL", "consistent"),
                "ball",
                {"Cells = 16, 16", "Order = 3"})
        .with("Time", {"End = 0.02"})
        .with("Output",
              {"Directory = own_grids", "Probes = 0.4, 0.45; 0.7, 0.5"})
        .with("Exact solution", {"Displacement = 0.1; t"});
    const auto run_quietly = [](const Text &text) {
      if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        {
          std::filesystem::remove_all("own_grids");
          std::ofstream("run.prm") << text.content;
        }
      MPI_Barrier(MPI_COMM_WORLD);
      std::ostringstream    out;
      std::streambuf *const buffer = std::cout.rdbuf(out.rdbuf());
      run_simulations("run.prm", MPI_COMM_WORLD);
      std::cout.rdbuf(buffer);
      MPI_Barrier(MPI_COMM_WORLD);
      return out.str();
    };
    const std::string header = run_quietly(text);
    for (const std::string part : {"  ball             13 x 14              3",
                                   "  box              10 x 10              2",
                                   "Bodies do not interact"})
      check("header: " + part,
            Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) > 0 ||
              header.find(part) != std::string::npos);
    if (header.find("Bodies do not") == std::string::npos ||
        header.find("10 x 10 ") == std::string::npos)
      print() << header << std::endl;
    for (const std::string file : {"fields.pvd",
                                   "files/points_0001.vtu",
                                   "files/grid_ball_0001.vtu",
                                   "files/grid_box_0001.vtu",
                                   "statistics.csv",
                                   "probes.csv",
                                   "summary.json"})
      check(file, std::filesystem::exists("own_grids/" + file));
    check("no other grid",
          !std::filesystem::exists("own_grids/files/grid_0000.vtu"));
  }



  void
  check_parameters()
  {
    const Text good = ball_and_box("USL", "consistent");
    const auto refused =
      [](const std::string &name, const Text &text, const std::string &wanted) {
        std::string message;
        try
          {
            Together together(text);
          }
        catch (const std::exception &error)
          {
            message = message_of(error);
          }
        MPI_Barrier(MPI_COMM_WORLD);
        check(name, message.find(wanted) != std::string::npos);
        if (message.find(wanted) == std::string::npos)
          print() << "<" << message << ">" << std::endl;
      };
    const std::vector<std::string> updated = {
      "Formulation = updated Lagrangian"};
    refused("updated Lagrangian",
            good.with("Scheme", updated).with("Grid", {"Per body = true"}),
            "'Grid/Per body' = true does not support");
    refused("updated Lagrangian with a section",
            with_grid(good.with("Scheme", updated), "box", {"Order = 1"}),
            "There is a section 'Body box/Grid', but");
    refused("a corner without cells",
            with_grid(good, "box", {"Lower corner = 0, 0"}),
            "'Body box/Grid' has a corner and no 'Cells'");
    refused("three numbers",
            with_grid(good, "box", {"Cells = 4, 4, 4"}),
            "'Body box/Grid/Cells' takes 2 numbers in 2D, or none, not 3");
    refused("corners",
            with_grid(good, "box", {"Upper corner = 1, 0", "Cells = 4, 4"}),
            "but 0 is not above 0");
    refused("a box that is too small",
            with_grid(good, "box", {"Upper corner = 0.7, 1", "Cells = 14, 20"}),
            "'Body box' sticks out of the grid");
    refused("an unknown body",
            with_grid(good, "bix", {"Cells = 4, 4"}),
            "does not name <bix>");
    refused("an unknown parameter",
            with_grid(good, "box", {"Cell size = 4"}),
            "Cell size");
    const Text periodic =
      good.with("Walls", {"Left = periodic", "Right = periodic"});
    refused("between periodic walls",
            with_grid(periodic, "box", {"Upper corner = 2, 1", "Cells = 8, 8"}),
            "all grids reach from wall to wall");
    refused("few cells between periodic walls",
            with_grid(periodic, "box", {"Cells = 2, 8"}),
            "2 cells between periodic walls");
    refused("bodies that share functions",
            good.with("Body box", {"Shape = box(0.65, 0.3, 0.85, 0.6)"}),
            "'Grid/Per body' = true");
    check_refused("a simulation of its own",
                  good.with("Grid", {"Per body = true"}),
                  "greville::CoupledSimulations takes");
  }
} // namespace



void
test_main()
{
  for (const std::string scheme : {"USL", "MUSL"})
    check_alone(scheme, "consistent");
  check_alone("USL", "lumped");
  check_alone("newmark", "consistent");
  check_alone("implicit-midpoint", "lumped");
  check_shared("USL", "consistent");
  check_shared("USL", "lumped");
  check_shared("newmark", "consistent");
  check_steps();
  check_states();
  check_stages();
  check_files();
  check_parameters();
}

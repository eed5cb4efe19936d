// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks total Lagrangian steps: the order of the splines, large rotations,
// bodies that leave the grid, implicit steps, and refused input.
#include "simulation.h"

namespace
{
  const std::vector<std::string> total = {"Formulation = total Lagrangian"};

  /// The relative error of the manufactured solution of the shipped file.
  double
  mms_error(const unsigned int n,
            const unsigned int p,
            const std::string &scheme)
  {
    SimulationParameters parameters(
      std::string(SOURCE_DIR) +
      "/../../prm/simulation/axis_aligned_mms_2d.prm");
    parameters.grid.cells           = {n, n};
    parameters.grid.degree          = p;
    BodyParameters &cube            = parameters.bodies.at("cube");
    cube.placement                  = Placement::gauss;
    cube.points_per_direction       = {p + 1};
    parameters.scheme.formulation   = "total Lagrangian";
    parameters.scheme.stress_update = scheme;
    parameters.time.end             = 0.004;
    parameters.time.step            = scheme == "USL" ? "2e-5" : "5e-5";
    parameters.newton.tolerance     = 1e-9;
    Simulation<2> simulation(parameters);
    while (!simulation.is_finished())
      simulation.step();
    const double t = simulation.state().time;
    return ExactSolution<2>(parameters.exact)
      .errors(simulation.bodies(), t, t, MPI_COMM_WORLD)
      .displacement->l2;
  }

  void
  check_order(const unsigned int p, const std::string &scheme)
  {
    const double coarse = mms_error(4, p, scheme);
    const double fine   = mms_error(8, p, scheme);
    const double order  = std::log2(coarse / fine);
    check("order of splines of order " + std::to_string(p) + ", " + scheme,
          order > p + 0.8);
    if (!(order > p + 0.8))
      print() << "  errors " << coarse << ", " << fine << ", order " << order
              << std::endl;
  }



  Text
  disk(const std::string &velocity, const std::string &scheme)
  {
    return block_2d("ball(0.5, 0.5, 0.31)", 9)
      .with("Scheme",
            {total[0], "Mass = consistent", "Stress update = " + scheme})
      .with("Body body",
            {"Points per direction = 3",
             "Jitter = 0.3",
             "Velocity = " + velocity})
      .with("Material solid", {"Model = neo-hookean"});
  }



  /// A body that flies far out of the grid, without and with a deformation.
  void
  check_flight()
  {
    Simulated<2>        flight(disk("3; -2", "USL").with("Time", {"End = 1"}));
    const Statistics<2> before = flight->statistics();
    const Statistics<2> after  = flight.run()->statistics();
    check("flight: centre",
          (after.center - before.center - Point<2>(3., -2.)).norm(),
          1e-12);
    check("flight: strain energy", after.strain / after.kinetic, 1e-14);

    // It spins and swings.
    for (const std::string scheme : {"USL", "newmark", "implicit-midpoint"})
      {
        Simulated<2> spinning(
          disk("3 - 4 * (y - 0.5) + (x - 0.5); -2 + 4 * (x - 0.5)", scheme)
            .with("Time", {"End = 0.5", "Step = 0.002"})
            .with("Newton", {"Tolerance = 1e-10"}));
        const Statistics<2> begin  = spinning->statistics();
        const Statistics<2> end    = spinning.run()->statistics();
        const double        energy = end.kinetic + end.strain - begin.kinetic;
        check(scheme + ": momentum",
              (end.momentum - begin.momentum).norm() / begin.momentum.norm(),
              1e-8);
        check(scheme + ": angular momentum",
              std::abs(end.angular_momentum[0] / begin.angular_momentum[0] -
                       1.),
              scheme == "implicit-midpoint" ? 1e-6 : 2e-3);
        check(scheme + ": strain energy", end.strain > 1e-3 * end.kinetic);
        check(scheme + ": energy",
              std::abs(energy) / begin.kinetic,
              scheme == "implicit-midpoint" ? 1e-6 : 2e-3);
      }
  }



  /// A block that is stretched to three times its length rests between walls.
  void
  check_stretched_block()
  {
    const Text block =
      block_2d("box(0, 0, 1, 1)", 4)
        .with("Scheme", {total[0], "Mass = consistent"})
        .with("Body body",
              {"Displacement = 2 * x; 0",
               "Placement = Gauss",
               "Points per direction = 3"})
        .with("Material solid", {"Model = neo-hookean", "Poisson ratio = 0"})
        .with("Walls",
              {"Left = sliding",
               "Right = sliding",
               "Bottom = sliding",
               "Top = sliding"})
        .with("Time", {"End = 0.2"});
    Simulated<2>        resting(block);
    const Statistics<2> sums = resting.run()->statistics();
    check("stretched block: energy of motion",
          sums.kinetic / sums.strain,
          1e-20);
    check("stretched block: centre", std::abs(sums.center[0] - 1.5), 1e-12);
  }



  /// Bodies that do not share functions are alone.
  void
  check_two_bodies()
  {
    const auto text = [](const std::string &bodies, const std::string &place) {
      Text result;
      result.add("Simulation", {"Bodies = " + bodies, "Materials = solid"})
        .add("Grid", {"Cells = 20, 20"})
        .add("Scheme", total)
        .add("Solver", {"Tolerance = 1e-10"})
        .add("Material solid",
             {"Model = linear-elastic",
              "Density = 1",
              "Young modulus = 100",
              "Poisson ratio = 0.3"});
      if (bodies != "other")
        result.add("Body body",
                   {"Material = solid",
                    "Shape = box(0.1, 0.1, 0.3, 0.3)",
                    "Velocity = 1; 0"});
      return result
        .with("Body other",
              {"Material = solid",
               "Shape = box(" + place + ", 0.1, 0.9, 0.3)",
               "Velocity = -1 + y; 0"})
        .with("Time", {"End = 1", "Step = 0.002"});
    };
    Simulated<2> both(text("body, other", "0.7"));
    Simulated<2> alone(text("other", "0.7"));
    both.run();
    alone.run();
    std::map<double, double> positions;
    both->bodies()[1].points.for_each(
      [&](const ConstPointRef<2> p) { positions[p.id()] = p.position(0); });
    double difference = 0.;
    alone->bodies()[0].points.for_each([&](const ConstPointRef<2> p) {
      if (positions.count(p.id()) == 1)
        difference =
          std::max(difference, std::abs(positions[p.id()] - p.position(0)));
    });
    check("bodies do not see one another", difference, 1e-10);
    check_refused("bodies that share functions",
                  text("body, other", "0.35"),
                  "they would move as one body");
  }



  /// Initial stresses: a column in geostatic equilibrium stays at rest, in 2D
  /// and 3D; and stresses that are let go of swing about the state without any
  /// as far as from there.
  template <int dim>
  void
  check_geostatic(const std::string &law, const std::string &scheme)
  {
    const Text column =
      (dim == 2 ? block_2d("box(0, 0, 1, 0.83)", 4)
                : block_3d("box(0, 0, 0, 1, 0.83, 1)", 3))
        .with("Scheme",
              {total[0], "Mass = consistent", "Stress update = " + scheme})
        .with("Body body",
              {"Placement = fitted",
               "Points per direction = 3",
               "K0 = 0.6",
               "Surface = 0.83"})
        .with("Loads", {dim == 2 ? "Gravity = 0; -30" : "Gravity = 0; -30; 0"})
        .with("Material solid", {"Model = " + law})
        .with("Newton", {"Tolerance = 1e-10"})
        .with("Walls",
              {"Left = sliding",
               "Right = sliding",
               dim == 2 ? "Front = free" : "Front = sliding",
               dim == 2 ? "Back = free" : "Back = sliding",
               "Bottom = sliding"})
        .with("Time", {"End = 0.2"})
        .with("Time", {scheme == "USL" ? "CFL number = 0.5" : "Step = 0.02"});
    Simulated<dim>        run(column);
    const Statistics<dim> begin = run->statistics();
    const Statistics<dim> end   = run.run()->statistics();
    const std::string     name =
      std::to_string(dim) + "D, " + law + ", " + scheme + ": ";
    check(name + "energy in the stress", begin.strain > 0.1);
    check(name + "energy of motion", end.kinetic / begin.strain, 1e-18);
    check(name + "centre", (end.center - begin.center).norm(), 1e-12);
    check(name + "stress", std::abs(end.strain / begin.strain - 1.), 1e-12);
  }

  void
  check_released_stress()
  {
    for (const std::string scheme : {"USL", "implicit-midpoint"})
      {
        Simulated<2> run(
          block_2d("box(0.13, 0.21, 0.77, 0.83)", 8)
            .with("Scheme",
                  {total[0], "Mass = consistent", "Stress update = " + scheme})
            .with("Body body",
                  {"Placement = fitted",
                   "Points per direction = 3",
                   "Stress = -40; 20; 0; 15"})
            .with("Material solid", {"Model = neo-hookean"})
            .with("Newton", {"Tolerance = 1e-10"})
            .with("Solver", {"Tolerance = 1e-10"})
            .with("Time", {"End = 0.3", "Step = 0.001"}));
        const Statistics<2> begin    = run->statistics();
        double              smallest = begin.strain, largest = 0., error = 0.;
        while (!run->is_finished())
          {
            run->step();
            const Statistics<2> now = run->statistics();
            smallest                = std::min(smallest, now.strain);
            largest                 = std::max(largest, now.kinetic);
            error                   = std::max(
              error, std::abs((now.kinetic + now.strain) / begin.strain - 1.));
          }
        check(scheme + ": energy", error, scheme == "USL" ? 0.03 : 1e-6);
        check(scheme + ": less stress", smallest / begin.strain, 0.3);
        check(scheme + ": energy of motion", largest > 0.7 * begin.strain);
        check(scheme + ": angular momentum",
              std::abs(run->statistics().angular_momentum[0]) / begin.strain,
              1e-8);
      }
  }



  /// The shipped body from an STL file: its volume is exact, and the reaction
  /// of its hub balances the load.
  void
  check_gear()
  {
    SimulationParameters parameters(std::string(SOURCE_DIR) +
                                    "/../../prm/simulation/rubber_gear_3d.prm");
    parameters.grid.cells = {10, 10, 2};
    parameters.time.end   = 0.25;
    Simulation<3> simulation(parameters);
    const double  volume = simulation.statistics().mass / 1000.;
    check("gear: volume", std::abs(volume / 50.602751953125e-6 - 1.), 3e-9);
    simulation.step();
    const auto loads = simulation.statistics().loads;
    check("gear: force", std::abs(loads[1].second[1] / 2.030625 - 1.), 1e-9);
    check("gear: balance", (loads[0].second + loads[1].second).norm(), 1e-4);
  }



  void
  check_parameters()
  {
    const Text good = disk("1; 0", "USL").with("Time", {"End = 0.01"});
    for (const auto &[section, line, wanted] :
         std::vector<std::array<std::string, 3>>{
           {{"Scheme", "Transfer = APIC", "'Scheme/Transfer' = APIC"}},
           {{"Walls", "Bottom = friction", "'Walls/Bottom' = friction"}}})
      check_refused(line, good.with(section, {line}), wanted);

    const auto stages = [&](const std::string &line) {
      return Text(good)
        .add("Simulation", {"Stages = one, two"})
        .add("Stage one", {"Reset displacements = false"})
        .add("Stage two", {line})
        .content;
    };
    std::string text = stages("Reset displacements = true");
    check_refused("reset of displacements",
                  Text(text + "subsection Stage two\n  subsection Time\n"
                              "    set End = 1\n  end\nend\n"),
                  "'Reset displacements' does not support");
    text = stages("Reset displacements = false");
    check_refused(
      "stages of both formulations",
      Text(text + "subsection Stage two\n  subsection Time\n"
                  "    set End = 1\n  end\n  subsection Scheme\n"
                  "    set Formulation = updated Lagrangian\n  end\nend\n"),
      "all stages need the same");
  }
} // namespace



void
test_main()
{
  for (const unsigned int p : {1, 2, 3})
    check_order(p, "USL");
  check_order(2, "newmark");
  check_order(3, "implicit-midpoint");
  check_flight();
  check_stretched_block();
  check_two_bodies();
  check_geostatic<2>("neo-hookean", "USL");
  check_geostatic<3>("neo-hookean", "USL");
  check_geostatic<2>("neo-hookean", "newmark");
  check_geostatic<2>("linear-elastic", "implicit-midpoint");
  check_geostatic<3>("linear-elastic", "quasi-static");
  check_released_stress();
  check_gear();
  check_parameters();
}

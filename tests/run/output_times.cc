// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks that output belongs to the end of a step, even if velocities are at
// half steps: free fall is exact in rows and fields, kinetic and total energy
// are of second order, no kick is counted twice for bodies at walls, and output
// does not affect the steps.
#include <deal.II/base/utilities.h>

#include <greville/run/simulation_run.h>

#include "simulation.h"

namespace
{
  using Rows = std::vector<std::map<std::string, double>>;

  /// The rows of a file of a run, on all processes.
  Rows
  rows_of(const std::string &name)
  {
    std::ifstream file(name);
    Rows          rows;
    std::string   line;
    std::getline(file, line);
    const auto columns = Utilities::split_string_list(line, ',');
    while (std::getline(file, line))
      {
        const auto values =
          Utilities::string_to_double(Utilities::split_string_list(line, ','));
        rows.emplace_back();
        for (unsigned int k = 0; k < columns.size(); ++k)
          rows.back()[columns[k]] = values[k];
      }
    return rows;
  }

  /// Run into a folder.
  template <int dim = 2>
  RunSummary
  write(const Text &text, const std::string &folder)
  {
    const auto parameters = text.parse();
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::filesystem::create_directories(folder);
    MPI_Barrier(MPI_COMM_WORLD);
    std::ostringstream out;
    const auto         summary =
      SimulationRun<dim>(parameters, folder, out, MPI_COMM_WORLD).run();
    MPI_Barrier(MPI_COMM_WORLD);
    return summary;
  }



  /// Rows and fields of a body that falls and spins not.
  void
  check_free_fall(const std::string &name, const Text &text)
  {
    const double g       = 2.;
    const auto   summary = write(text, "fall");
    const auto   rows    = rows_of("fall/statistics.csv");
    const auto   probes  = rows_of("fall/probes.csv");
    check(name + ": rows", rows.size() == 12 && probes.size() == 12);
    double worst = 0.;
    for (unsigned int k = 0; k < rows.size(); ++k)
      {
        const auto  &row = rows[k];
        const double t = row.at("time"), m = row.at("mass"), v = 0.1 - g * t;
        for (const double error :
             {row.at("momentum_y") - m * v,
              row.at("kinetic") - 0.5 * m * (0.04 + v * v),
              row.at("total") - rows[0].at("total"),
              row.at("kinetic") - row.at("work_gravity") -
                rows[0].at("kinetic"),
              row.at("largest_speed") - std::hypot(0.2, v),
              row.at("angular_momentum") -
                m * (row.at("center_x") * v - row.at("center_y") * 0.2),
              probes[k].at("vx0") - 0.2,
              probes[k].at("vy0") - v})
          worst = std::max(worst, std::abs(error));
      }
    check(name + ": rows belong to their time", worst, 1e-11);
    check(name + ": error of the velocity",
          summary.errors.velocity->max,
          1e-11);
  }



  /// The velocities of a state in free fall, with the mass of its grid.
  void
  check_velocities(const std::string &name,
                   const State<2>    &state,
                   const VectorType  &mass)
  {
    const Tensor<1, 2> g({0., -2.});
    const Tensor<1, 2> v         = Tensor<1, 2>({0.2, 0.1}) + state.time * g;
    double             of_points = 0., of_grid = 0.;
    state.bodies[0].points.for_each([&](const unsigned int, const auto p) {
      of_points = std::max(of_points, (p.velocity() - v).norm());
    });
    for (unsigned int i = 0; i < mass.locally_owned_size(); ++i)
      if (mass.local_element(i) > 1e-9)
        for (unsigned int d = 0; d < 2; ++d)
          of_grid = std::max(
            {of_grid,
             std::abs(state.field.velocity[d].local_element(i) - v[d]),
             std::abs(state.field.acceleration[d].local_element(i) - g[d])});
    check(name + ": velocities of points", max_all(of_points), 1e-11);
    check(name + ": fields of the grid", max_all(of_grid), 1e-9);
    check(name + ": their time",
          std::abs(state.velocity_time - state.time),
          1e-14);
  }

  void
  check_fields(const std::string &name, const Text &text)
  {
    Simulated<2> run(text);
    for (unsigned int k = 0; k < 7; ++k)
      run->step();
    const State<2> before = run->state();
    check(name + ": velocities lag", before.velocity_time < before.time - 1e-3);
    State<2>   late;
    VectorType mass;
    run->ask_for_row(0., {}, [&]() {
      mass = run->mass().lumped();
      late = run->state();
    });
    run->step();
    check(name + ": late fields, time", late.time == before.time);
    check_velocities(name + ", late", late, mass);
    run->set_state(before);
    run->finish();
    check_velocities(name, run->state(), run->mass().lumped());
  }



  /// A bar between two walls that vibrates: kinetic energy at a time, in rows
  /// or as steps have it, and by how much the total energy of rows varies.
  struct Vibration
  {
    double kinetic = 0., lagging = 0., variation = 0.;
  };

  Vibration
  vibration(const Text &bar, const double step)
  {
    Simulated<2> run(
      bar.with("Time", {"Step = " + std::to_string(step), "End = 0.0625"}));
    Vibration    result;
    const double start = run->statistics().kinetic;
    while (!run->is_finished())
      {
        run->step();
        result.lagging       = run->statistics().kinetic / start;
        const State<2> state = run->state();
        run->finish();
        const auto row = run->statistics();
        run->set_state(state);
        result.kinetic = row.kinetic / start;
        result.variation =
          std::max(result.variation,
                   std::abs((row.kinetic + row.strain) / start - 1.));
      }
    return result;
  }

  void
  check_order(const std::string &name, const Text &bar)
  {
    const double    h = 1. / 512.;
    const Vibration a = vibration(bar, h), b = vibration(bar, h / 2.),
                    c = vibration(bar, h / 4.);
    const auto order  = [](const double x, const double y, const double z) {
      return std::log2(std::abs((x - y) / (y - z)));
    };
    check(name + ": order of the kinetic energy in rows",
          std::abs(order(a.kinetic, b.kinetic, c.kinetic) - 2.),
          0.15);
    check(name + ": order of that of steps",
          std::abs(order(a.lagging, b.lagging, c.lagging) - 1.),
          0.2);
    check(name + ": order of the total energy",
          std::abs(std::log2(b.variation / c.variation) - 2.),
          0.2);
  }



  bool
  on_all(const bool condition)
  {
    return Utilities::MPI::min<unsigned int>(condition, MPI_COMM_WORLD) == 1;
  }

  /// All numbers that a checkpoint would have.
  std::vector<double>
  numbers(const CoupledSimulations<2> &simulations)
  {
    std::vector<double> result;
    for (const DistributedTable &table : simulations.tables())
      result.insert(result.end(), table.values.begin(), table.values.end());
    return result;
  }

  /// Return whether points have the same positions and stresses.
  bool
  same_positions(const State<2> &a, const State<2> &b)
  {
    std::array<std::vector<double>, 2> numbers;
    for (const unsigned int k : {0, 1})
      for (const Body<2> &body : (k == 0 ? a : b).bodies)
        body.points.for_each([&](const unsigned int, const auto p) {
          for (unsigned int d = 0; d < 2; ++d)
            numbers[k].push_back(p.position()[d]);
          for (unsigned int c = 0; c < PointLayout<2>::n_stress; ++c)
            numbers[k].push_back(p.stress(c));
        });
    return numbers[0] == numbers[1];
  }

  /// Steps with output of all steps, of some or of none. What is shown belongs
  /// to the state before the step: its positions are there to the bit.
  void
  check_trajectory(const std::string &name, const Text &text)
  {
    const auto          parameters = text.parse();
    std::vector<double> none;
    for (const unsigned int every : {0, 1, 7})
      {
        CoupledSimulations<2> simulations(parameters);
        bool                  same = true, changes = false;
        for (unsigned int k = 0; k < 60 && !simulations.is_finished(); ++k)
          {
            if (every == 0 || k % every != 0 || !simulations.rows_are_late())
              {
                simulations.step();
                continue;
              }
            std::vector<State<2>> late(simulations.n_parts());
            simulations.ask_for_row({}, [&](const unsigned int part) {
              changes    = true;
              late[part] = simulations.part(part).state();
            });
            const auto before = simulations.state();
            simulations.step();
            for (unsigned int part = 0; part < late.size(); ++part)
              // Cells that are shared anew have points in another order.
              same =
                same && (late[part].n_partitions != before[part].n_partitions ||
                         same_positions(late[part], before[part]));
          }
        // Output finds the contact of the next step, too.
        simulations.find_contact();
        check(name + ": there is output", changes == (every > 0));
        check(name + ": of the state before the step", on_all(same));
        if (every == 0)
          none = numbers(simulations);
        else
          check(name + ": steps do not see output",
                on_all(numbers(simulations) == none));
      }
  }



  /// Runs that write much and little have the same rows and end in the same
  /// state.
  void
  check_files(const Text &text)
  {
    write(text.with("Output", {"Statistics every = 0"}), "often");
    write(text.with("Output", {"Statistics every = 0.01"}), "seldom");
    const auto often  = rows_of("often/statistics.csv"),
               seldom = rows_of("seldom/statistics.csv");
    unsigned int n = 0, k = 0;
    for (const auto &row : often)
      if (k < seldom.size() && row.at("time") == seldom[k].at("time"))
        {
          ++k;
          n += row == seldom[k - 1];
        }
    check("rows that are written often and seldom",
          n == seldom.size() && n > 5 && often.size() > 3 * n);
  }



  /// Where a body hits a wall, rows are between the steps before and after.
  void
  check_impact(const std::string &name, const Text &text)
  {
    Simulated<2> run(text);
    const double start  = run->statistics().kinetic;
    double       before = start, row = start, above = 0., below = 0.;
    unsigned int n_hits = 0;
    for (unsigned int k = 0; k < 80; ++k)
      {
        run->step();
        const double after = run->statistics().kinetic;
        above              = std::max(above, row - std::max(before, after));
        below              = std::max(below, std::min(before, after) - row);
        n_hits += after < 0.995 * before;
        before               = after;
        const State<2> state = run->state();
        run->finish();
        row = run->statistics().kinetic;
        run->set_state(state);
      }
    check(name + ": it hits the wall", n_hits > 5);
    check(name + ": rows above the steps", above / start, 1e-3);
    // A kinetic energy that is the smallest between them is below both.
    check(name + ": rows below the steps", below / start, 3e-3);
  }



  /// The velocity of a wall that has a displacement.
  void
  check_wall(const Text &text)
  {
    Simulated<2> run(
      text.with("Walls", {"Top = moving", "Top displacement = 0.1 * t^2; 0"})
        .with("Scheme", {"Mass = consistent"})
        .with("Body body", {"Shape = box(0.2, 0.3, 0.8, 1)"})
        .with("Time", {"Step = 0.002", "End = 0.02"}));
    run.run()->finish();
    const auto &space = run->space();
    double      worst = 0.;
    for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
      if (space.on_side(i, 3))
        worst =
          std::max(worst,
                   std::abs(run->state().field.velocity[0].local_element(i) -
                            0.2 * run->state().time));
    check("velocity of a wall", max_all(worst), 1e-6);
  }



  /// A step on a layer: the front of all points is that of the layer.
  void
  check_runout(const Text &text)
  {
    const auto runout_above = [&](const std::string &y) {
      const Text on_layer =
        text.with("Body body",
                  {"Shape = union(box(0.125, 0, 0.875, 0.25), "
                   "box(0.125, 0, 0.375, 0.5))"});
      return Simulated<2>(y.empty()
                            ? on_layer
                            : on_layer.with("Output", {"Front above = " + y}))
        ->statistics()
        .runout;
    };
    check("front of the layer", std::abs(runout_above("") - 0.875), 1e-9);
    check("front above the layer",
          std::abs(runout_above("0.25") - 0.375),
          1e-9);
    check("front above all", std::abs(runout_above("0.5")), 0.);
  }



  /// A probe in the middle of a block that begins to shear in two directions.
  void
  check_probe_3d()
  {
    write<3>(block_3d("box(0, 0, 0, 1, 1, 1)", 8)
               .with("Body body", {"Velocity = 0.1 * z; 0.2 * z; 0"})
               .with("Output",
                     {"Probes = 0.5, 0.5, 0.5", "Grid fields = false"})
               .with("Time", {"End = 0.003", "Step = 0.001"}),
             "shear");
    const auto   row   = rows_of("shear/probes.csv").back();
    const double shear = 100. / 2.6 * 0.1 * row.at("time");
    check("shear stress xz", std::abs(row.at("stress_xz0") / shear - 1.), 1e-3);
    check("shear stress yz", std::abs(row.at("stress_yz0") / shear - 2.), 2e-3);
    check("other stress", std::abs(row.at("stress_xy0") / shear), 1e-3);
  }



  /// What follows a copy of a state depends on the copy alone, also where
  /// contacts slide.
  void
  check_copy(const Text &text)
  {
    CoupledSimulations<2> simulations(text.parse());
    for (unsigned int k = 0; k < 30; ++k)
      simulations.step();
    const auto          copy = simulations.state();
    std::vector<double> first;
    for (unsigned int n = 0; n < 2; ++n)
      {
        simulations.set_state(copy);
        for (unsigned int k = 0; k < 20; ++k)
          simulations.step();
        if (n == 0)
          first = numbers(simulations);
      }
    check("sliding, from a copy", on_all(numbers(simulations) == first));
  }
} // namespace



void
test_main()
{
  const Text falling =
    block_2d("box(0.2, 0.55, 0.6, 0.9)")
      .with("Material solid", {"Young modulus = 0.1"})
      .with("Body body", {"Velocity = 0.2; 0.1"})
      .with("Loads", {"Gravity = 0; -2"})
      .with("Exact solution", {"Velocity = 0.2; 0.1 - 2 * t"})
      .with("Output", {"Probes = 0.4, 0.7", "Grid fields = false"})
      // Steps of two lengths.
      .with("Time", {"End = 0.21", "Step = 0.02", "Too large step = ignore"});
  for (const std::string scheme : {"USL", "MUSL"})
    for (const std::string transfer : {"FLIP", "PIC", "APIC", "Taylor"})
      {
        const Text text =
          falling.with("Scheme",
                       {"Stress update = " + scheme, "Transfer = " + transfer});
        check_free_fall(scheme + ", " + transfer, text);
        check_fields(scheme + ", " + transfer, text);
      }
  const Text exact_mass = falling.with("Scheme", {"Mass = consistent"})
                            .with("Solver", {"Tolerance = 1e-13"});
  check_free_fall("consistent", exact_mass);
  check_fields("consistent", exact_mass);

  const Text bar =
    block_2d("box(0, 0, 1, 0.25)")
      .with("Grid", {"Cells = 16, 4", "Upper corner = 1, 0.25", "Order = 2"})
      .with("Material solid", {"Poisson ratio = 0"})
      .with("Body body", {"Velocity = 0.01 * sin(pi * x); 0"})
      .with("Solver", {"Tolerance = 1e-12"})
      .with("Walls", {"Left = fixed", "Right = fixed"});
  for (const std::string scheme : {"USL", "MUSL"})
    check_order("bar, " + scheme,
                bar.with("Scheme",
                         {"Mass = consistent",
                          "Stress update = " + scheme,
                          "Formulation = total Lagrangian"}));

  const Text ball =
    block_2d("ball(0.4, 0.26, 0.21)", 12)
      .with("Grid", {"Order = 2"})
      .with("Body body", {"Velocity = 3; -4", "Points per direction = 3"})
      .with("Material solid", {"Model = neo-hookean"})
      .with("Loads", {"Gravity = 0; -9"})
      .with("Walls",
            {"Bottom = friction", "Bottom friction = 0.3", "Left = sliding"})
      .with("Time", {"End = 10"});
  for (const std::string mass : {"lumped", "consistent"})
    {
      const Text text = with_mass(ball, mass);
      check_trajectory("ball, " + mass, text);
      check_trajectory("ball, " + mass + ", body force",
                       text.with("Loads", {"Body force = -x; sin(20 * t)"}));
      check_trajectory(
        "ball, " + mass + ", MUSL, share, damping",
        text.with("Scheme", {"Stress update = MUSL", "FLIP share = 0.9"})
          .with("Loads", {"Cundall damping = 0.2"}));
      check_trajectory(
        "ball, " + mass + ", piston",
        text.with("Simulation", {"Rigid bodies = piston", "Contacts = push"})
          .with("Rigid body piston",
                {"Shape = box(0.7, 0, 0.85, 1)",
                 "Velocity = 1 + cos(9 * t); 0"})
          .with("Contact push", {"Bodies = body, piston", "Penalty = 3"}));
    }
  check_runout(falling);
  check_probe_3d();
  for (const std::string transfer : {"APIC", "Taylor"})
    check_trajectory("ball, " + transfer,
                     ball.with("Scheme", {"Transfer = " + transfer}));
  check_trajectory(
    "ball, p-multigrid",
    with_mass(ball, "consistent").with("Solver", {"Method = cg-p-multigrid"}));
  check_trajectory("load on a surface",
                   ball.with("Simulation", {"Surface loads = load"})
                     .with("Body body", {"Placement = fitted"})
                     .with("Scheme", {"Mass = consistent"})
                     .with("Walls", {"Bottom = fixed", "Bottom friction = 0"})
                     .with("Surface load load",
                           {"Body = body", "Kind = dashpot"}));
  check_trajectory(
    "two grids",
    ball.with("Simulation", {"Bodies = body, other"})
      .with("Body other",
            {"Material = solid",
             "Shape = box(0.3, 0.3, 0.7, 0.8)",
             "Velocity = -2; 1"})
      .with("Grid", {"Per body = true"})
      .with("Walls", {"Bottom = fixed", "Bottom friction = 0"})
      .with("Scheme", {"Mass = consistent", "Formulation = total Lagrangian"}));
  for (const std::string mass : {"lumped", "consistent"})
    check_impact("ball, " + mass, with_mass(ball, mass));
  check_files(
    with_mass(ball, "consistent").with("Time", {"End = 0.1", "Step = 0.001"}));
  check_wall(block_2d("box(0.2, 0.3, 0.8, 1)"));
  check_copy(with_mass(ball, "consistent"));
}

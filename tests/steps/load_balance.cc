// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks the redistribution of cells among processes while points move: work
// stays balanced, results of the main code paths are the same without it, and
// runs from saved states continue with the same bits.
#include <greville/run/simulation_run.h>
#include <greville/steps/coupled_simulations.h>
#include <greville/steps/load_balance.h>
#include <greville/steps/state_tables.h>

#include "simulation.h"

namespace
{
  bool
  is_parallel()
  {
    return Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;
  }



  // A ball that flies through a grid and hits its walls.
  const Text flying = block_2d("ball(0.3, 0.5, 0.21)", 12)
                        .with("Body body", {"Velocity = 5; -3"})
                        .with("Walls",
                              {"Bottom = friction",
                               "Bottom friction = 0.3",
                               "Left = sliding",
                               "Right = sliding"})
                        .with("Time", {"End = 1e3", "Maximum steps = 60"})
                        .with("Load balance", {"Threshold = 0"});



  template <int dim>
  std::vector<double>
  numbers(const Simulation<dim> &simulation)
  {
    std::vector<double> result = {simulation.state().time,
                                  double(simulation.state().n_partitions),
                                  simulation.state().imbalance};
    for (const Body<dim> &body : simulation.bodies())
      body.points.for_each([&](const unsigned int, const auto p) {
        for (unsigned int k = 0; k < body.points.layout().size; ++k)
          result.push_back(p[k]);
      });
    return result;
  }



  /// The largest difference of statistics, of momenta relative to m v.
  template <int dim>
  double
  difference(const Statistics<dim> &a, const Statistics<dim> &b)
  {
    const auto   columns = a.columns(), others = b.columns();
    const double momentum = std::sqrt(2. * a.mass * a.kinetic) + 1e-300;
    double       result   = 0.;
    for (unsigned int k = 0; k < columns.size(); ++k)
      {
        const std::string &column = columns[k].first;
        // How often a solver iterates depends on its blocks.
        if (column == "iterations" || column == "active")
          continue;
        double scale = std::abs(columns[k].second) + 1e-9;
        if (column.find("momentum") != std::string::npos)
          scale = momentum;
        else if (column.rfind("load_", 0) == 0)
          scale = a.loads[0].second.norm();
        result =
          std::max(result,
                   std::abs(columns[k].second - others[k].second) / scale);
      }
    return result;
  }



  /// Compare the work of processes after so many steps.
  std::function<void(SimulationParameters &)>
  check_every(const unsigned int n_steps)
  {
    return [n_steps](SimulationParameters &parameters) {
      parameters.load_balance.check_every = n_steps;
    };
  }



  template <int dim>
  void
  test(const std::string &name,
       const Text        &text,
       const double       tolerance = 1e-10,
       const bool         moves     = true)
  {
    Simulated<dim> without(text),
      with(text.with("Load balance", {"Threshold = 1"}), check_every(4));
    without.run();
    with.run();
    check(name,
          difference(without->statistics(), with->statistics()),
          tolerance);
    check(name + ", number of partitions",
          is_parallel() ? with->state().n_partitions >= (moves ? 5 : 1)
                        : with->state().n_partitions == 0);
    check(name + ", none without", without->state().n_partitions == 0);
  }



  unsigned int
  n_partitions(const std::string &threshold, const unsigned int every)
  {
    return Simulated<2>(flying.with("Load balance",
                                    {"Threshold = " + threshold}),
                        check_every(every))
      .run()
      ->state()
      .n_partitions;
  }



  /// Work stays shared where a threshold is given, and each parameter counts.
  void
  check_parameters()
  {
    const auto largest = [](const Text &text) {
      Simulated<2> run(text, check_every(2));
      double       result = 1.;
      while (!run->is_finished())
        {
          run->step();
          result =
            std::max(result,
                     imbalance(work_of_process(run->state(), run->space()),
                               MPI_COMM_WORLD));
        }
      return result;
    };
    const Text balanced = flying.with("Load balance", {"Threshold = 1.2"});
    // Cells are few, and p4est keeps those of a parent together: more than
    // three processes do not get the same share.
    const double       without = largest(flying), with = largest(balanced);
    const unsigned int n = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    check("imbalance without", n == 1 || without > 1.5);
    check("imbalance with a threshold", with, n <= 3 ? 1.4 : 0.7 * without);

    check("Threshold", n_partitions("1e3", 0) == 0);
    const unsigned int often = n_partitions("1", 0),
                       rare  = n_partitions("1", 20);
    check("steps between comparisons",
          is_parallel() ? often > rare && rare > 0 : often == 0);
    check("Threshold = 1", n_partitions("1", 10) == (is_parallel() ? 5 : 0));

    check_refused("Threshold below 1",
                  flying.with("Load balance", {"Threshold = 0.5"}),
                  "'Load balance/Threshold' is 0.5");
  }



  /// Copies from before a partition, and tables in files.
  void
  check_states()
  {
    const Text text =
      flying.with("Load balance", {"Threshold = 1"})
        .with("Scheme", {"Mass = consistent"})
        .with("Walls", {"Bottom = sliding", "Bottom friction = 0"})
        .with("Solver", {"Tolerance = 1e-13"})
        .with("Time", {"Maximum steps = 1000"});
    const auto run_steps = [](Simulation<2> &simulation, const unsigned int n) {
      for (unsigned int k = 0; k < n; ++k)
        simulation.step();
      return numbers(simulation);
    };
    Simulated<2> run(text, check_every(7));
    run_steps(run.simulation, 17);
    const State<2> copy = run->state();
    run->set_state(copy);
    const auto first = run_steps(run.simulation, 15);
    run->set_state(copy);
    check("a copy from before partitions",
          run_steps(run.simulation, 15) == first);

    TablesFile content;
    content.tables = make_tables(run->state(), run->space());
    write_tables("state.h5", content, MPI_COMM_WORLD);
    const auto set_from = [](Simulation<2>    &simulation,
                             const TablesFile &tables) {
      State<2> state = simulation.state();
      set_from_tables(state, tables, simulation.grid());
      simulation.set_state(state);
    };
    set_from(run.simulation, content);
    Simulated<2> resumed(text, check_every(7));
    set_from(resumed.simulation, read_tables("state.h5", MPI_COMM_WORLD));
    check("from a file", numbers(resumed.simulation) == first);
    check("the same bits",
          run_steps(resumed.simulation, 15) == run_steps(run.simulation, 15));
    check("partitions in between",
          !is_parallel() || run->state().n_partitions >= 5);

    Simulated<2> alone(text, MPI_COMM_SELF);
    set_from(alone.simulation, read_tables("state.h5", MPI_COMM_SELF));
    run_steps(alone.simulation, 15);
    check("on one process",
          difference(run->statistics(), alone->statistics()),
          1e-6);
    MPI_Barrier(MPI_COMM_WORLD);
  }



  void
  check_output()
  {
    auto parameters = flying.with("Time", {"Maximum steps = 6"})
                        .with("Load balance", {"Threshold = 1"})
                        .with("Output", {"Load = true"})
                        .parse();
    check_every(2)(parameters);
    const bool is_first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    if (is_first)
      std::filesystem::create_directories("load");
    MPI_Barrier(MPI_COMM_WORLD);
    std::ostringstream out;
    SimulationRun<2>(parameters, "load", out, MPI_COMM_WORLD).run();
    if (!is_first)
      return;
    std::ifstream file("load/statistics.csv");
    std::string   header, line, last;
    std::getline(file, header);
    while (std::getline(file, line))
      last = line;
    const std::string columns = "largest_load,imbalance,partitions";
    check("Output/Load",
          header.size() > columns.size() &&
            header.substr(header.size() - columns.size()) == columns);
    check("Output/Load, partitions",
          last.substr(last.rfind(',') + 1) == (is_parallel() ? "2" : "0"));
  }
} // namespace



void
test_main()
{
  test<2>("lumped", flying);
  test<2>("MUSL, APIC",
          flying.with("Scheme", {"Stress update = MUSL", "Transfer = APIC"}));
  test<2>("fmpm", flying.with("Scheme", {"Mass = fmpm-2"}));
  test<2>("consistent",
          flying.with("Scheme", {"Mass = consistent"})
            .with("Walls", {"Bottom = sliding", "Bottom friction = 0"})
            .with("Solver", {"Tolerance = 1e-13"}),
          1e-8);
  test<2>("two bodies",
          flying.with("Simulation", {"Bodies = body, wall"})
            .with("Body wall",
                  {"Material = solid",
                   "Shape = box(0.8, 0.1, 0.9, 0.9)",
                   "Velocity = -2; 0"}));
  test<2>("points that leave the grid",
          flying.with("Scheme", {"Points outside = remove"})
            .with("Body body", {"Velocity = 12; 0"})
            .with("Walls", {"Right = free"}));
  test<2>("generalized-alpha",
          flying
            .with("Scheme",
                  {"Mass = consistent", "Stress update = generalized-alpha"})
            .with("Body body", {"Velocity = 4; -3 * y"})
            .with("Walls", {"Bottom = sliding", "Bottom friction = 0"})
            .with("Time", {"Step = 0.005", "Maximum steps = 24"})
            .with("Loads", {"Gravity = 0; -20"})
            .with("Newton", {"Tolerance = 1e-10"})
            .with("Solver", {"Tolerance = 1e-13"}),
          1e-8);
  // Points on surfaces, which the first partition does not count, and cells
  // that are not left.
  test<2>("total Lagrangian",
          flying
            .with("Scheme",
                  {"Formulation = total Lagrangian", "Mass = consistent"})
            .with("Walls", {"Bottom = free", "Bottom friction = 0"})
            .with("Body body", {"Placement = fitted"})
            .with("Simulation", {"Surface loads = all"})
            .with("Surface load all",
                  {"Body = body", "Kind = pressure", "Pressure = 5"})
            .with("Solver", {"Tolerance = 1e-13"}),
          1e-8,
          false);
  test<3>("3D",
          block_3d("ball(0.3, 0.5, 0.5, 0.2)", 6)
            .with("Body body", {"Velocity = 3; -2 * y; 1"})
            .with("Time", {"End = 1e3", "Maximum steps = 30"})
            .with("Load balance", {"Threshold = 0"}));
  check_parameters();
  check_states();
  check_output();
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2 4

// Checks a state as tables in a file: a simulation that reads it continues with
// the same bits on the same number of processes, and with the same statistics
// on others.
#include <greville/steps/state_tables.h>

#include "simulation.h"

namespace
{
  constexpr unsigned int n_before = 30, n_after = 40;

  template <int dim>
  std::vector<double>
  numbers(const Simulation<dim> &simulation)
  {
    std::vector<double> result = {simulation.state().time,
                                  simulation.state().step,
                                  simulation.state().estimates.critical,
                                  double(simulation.state().n_steps)};
    for (const Body<dim> &body : simulation.bodies())
      body.points.for_each([&](const unsigned int, const auto p) {
        for (unsigned int k = 0; k < body.points.layout().size; ++k)
          result.push_back(p[k]);
      });
    return result;
  }



  template <int dim>
  void
  set_from(Simulation<dim> &simulation, const TablesFile &content)
  {
    State<dim> state = simulation.state();
    set_from_tables(state, content, simulation.grid());
    simulation.set_state(state);
  }



  template <int dim>
  void
  run_steps(Simulation<dim> &simulation, const unsigned int n)
  {
    for (unsigned int k = 0; k < n; ++k)
      simulation.step();
  }



  template <int dim>
  void
  check_equal(const std::string     &name,
              const Statistics<dim> &a,
              const Statistics<dim> &b,
              const double           tolerance)
  {
    const auto columns = a.columns(), others = b.columns();
    // Momenta vanish, relative to m v.
    const double momentum = std::sqrt(2. * a.mass * a.kinetic) + 1e-300;
    for (unsigned int k = 0; k < columns.size(); ++k)
      {
        const std::string &column = columns[k].first;
        // How often a solver iterates depends on its blocks.
        if (column == "iterations")
          continue;
        double scale = std::abs(columns[k].second) + 1e-9;
        if (column.find("momentum") != std::string::npos)
          scale = momentum;
        else if (column.rfind("load_", 0) == 0)
          scale = a.loads[0].second.norm();
        check(name + ", " + column,
              std::abs(columns[k].second - others[k].second) / scale,
              tolerance);
      }
  }



  template <int dim>
  void
  test(const std::string &name,
       const Text        &text,
       const double       tolerance = 1e-10)
  {
    // It goes on, from the same tables; factorizations would else be those of
    // before.
    Simulated<dim> whole(text);
    run_steps(whole.simulation, n_before);
    TablesFile content;
    content.tables = make_tables(whole->state(), whole->space());
    write_tables("state.h5", content, MPI_COMM_WORLD);
    const std::vector<double> at_write = numbers(whole.simulation);
    set_from(whole.simulation, content);
    check(name + ", the state itself", numbers(whole.simulation) == at_write);
    run_steps(whole.simulation, n_after);

    Simulated<dim> resumed(text);
    set_from(resumed.simulation, read_tables("state.h5", MPI_COMM_WORLD));
    check(name + ", the state that is read",
          numbers(resumed.simulation) == at_write);
    run_steps(resumed.simulation, n_after);
    check(name + ", the same bits",
          numbers(resumed.simulation) == numbers(whole.simulation));

    // A cell that there is not, in a row of one process.
    for (const double cell : {-1., 1e9, double(NAN)})
      {
        TablesFile wrong = read_tables("state.h5", MPI_COMM_WORLD);
        for (DistributedTable &table : wrong.tables)
          if (table.name.rfind("body ", 0) == 0 && table.n_rows() > 0 &&
              Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
            table.values[0] = cell;
        std::string message;
        try
          {
            set_from(resumed.simulation, wrong);
          }
        catch (const std::exception &error)
          {
            message = message_of(error);
          }
        check(name + ", a point in no cell: <" + message + ">",
              message.find("is in the cell") != std::string::npos);
      }

    // Each process by itself.
    Simulated<dim> alone(text, MPI_COMM_SELF);
    set_from(alone.simulation, read_tables("state.h5", MPI_COMM_SELF));
    run_steps(alone.simulation, n_after);
    check_equal(name + " on one process",
                whole->statistics(),
                alone->statistics(),
                tolerance);
    MPI_Barrier(MPI_COMM_WORLD);
  }
} // namespace



void
test_main()
{
  const Text text =
    block_2d("box(0.2, 0, 0.6, 0.4)", 10)
      .with("Body body", {"Velocity = 1; -0.5 * y"})
      .with("Loads", {"Gravity = 0; -20"})
      .with("Walls", {"Bottom = friction", "Bottom friction = 0.3"})
      .with("Time", {"End = 10"});
  test<2>("lumped", text);
  test<2>("MUSL, APIC",
          text.with("Scheme", {"Stress update = MUSL", "Transfer = APIC"}));
  test<2>("fmpm", text.with("Scheme", {"Mass = fmpm-3"}));
  test<2>("consistent",
          text.with("Scheme", {"Mass = consistent"})
            .with("Walls", {"Bottom = sliding", "Bottom friction = 0"})
            .with("Solver", {"Tolerance = 1e-13"}),
          1e-9);

  const Text total =
    text.with("Scheme", {"Formulation = total Lagrangian"})
      .with("Body body", {"Placement = fitted"})
      .with("Simulation", {"Surface loads = top"})
      .with("Surface load top",
            {"Body = body",
             "Where = y > 0.3999",
             "Kind = pressure",
             "Pressure = 5"})
      .with("Walls", {"Bottom = sliding", "Bottom friction = 0"})
      .with("Solver", {"Tolerance = 1e-13"});
  test<2>("total Lagrangian, lumped", total);
  test<2>("total Lagrangian, consistent",
          total.with("Scheme", {"Mass = consistent"}),
          1e-9);
  const Text alpha =
    total
      .with("Scheme",
            {"Mass = consistent", "Stress update = generalized-alpha"})
      .with("Time", {"Step = 0.005"})
      .with("Newton", {"Tolerance = 1e-12"});
  test<2>("generalized-alpha", alpha, 1e-8);
  test<3>("3D",
          block_3d("ball(0.5, 0.5, 0.5, 0.3)")
            .with("Body body", {"Velocity = 0.2; -0.5 * y; 0.1 * z"})
            .with("Time", {"End = 10"}));
}

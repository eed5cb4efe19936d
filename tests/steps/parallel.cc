// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 4

// Checks that the same run on all processes and on one has the same statistics
// in every step, with points that cross process borders, for the main code
// paths.
#include "simulation.h"

template <int dim>
void
test(const std::string &name, const Text &text, const double tolerance)
{
  const auto          parameters = text.parse();
  Simulation<dim>     all(parameters, MPI_COMM_WORLD);
  Simulation<dim>     one(parameters, MPI_COMM_SELF);
  double              worst = 0.;
  std::vector<double> scale;
  while (!all.is_finished())
    {
      all.step();
      one.step();
      const auto all_now = all.statistics();
      const auto a = all_now.values(), b = one.statistics().values();
      const auto names = Statistics<dim>::names({}, parameters.general.bodies);
      scale.resize(a.size(), 0.);
      for (unsigned int k = 0; k < a.size(); ++k)
        if (names[k] != "iterations")
          {
            // Relative to the largest so far; those of bodies that meet add up
            // to almost nothing, and are relative to that of their speeds.
            scale[k] = std::max({scale[k], std::abs(a[k]), std::abs(b[k])});
            if (names[k].find("momentum") != std::string::npos)
              scale[k] =
                std::max(scale[k],
                         std::sqrt(2. * all_now.mass * all_now.kinetic));
            if (scale[k] > 1e-10)
              worst = std::max(worst, std::abs(a[k] - b[k]) / scale[k]);
          }
    }
  check(name, max_all(worst), tolerance);
  check(name + ", points crossed borders",
        Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1 ||
          Utilities::MPI::sum(all.state().n_sent, MPI_COMM_WORLD) > 0);
}



void
test_main()
{
  const Text disks =
    block_2d("ball(0.32, 0.35, 0.2)", 16)
      .with("Simulation", {"Bodies = body, other"})
      .with("Body body", {"Velocity = 1; 1", "Points per direction = 3"})
      .with("Body other",
            {"Material = solid",
             "Shape = ball(0.7, 0.7, 0.2)",
             "Points per direction = 3",
             "Jitter = 0.3",
             "Velocity = -1; -1"})
      .with("Time", {"End = 1e3", "Maximum steps = 100", "CFL number = 0.3"});
  for (const std::string scheme : {"USL", "MUSL"})
    test<2>(scheme, disks.with("Scheme", {"Stress update = " + scheme}), 1e-10);
  test<2>("APIC, order 3",
          disks.with("Scheme", {"Transfer = APIC"}).with("Grid", {"Order = 3"}),
          1e-10);
  test<2>("fmpm-2", disks.with("Scheme", {"Mass = fmpm-2"}), 1e-10);

  // A body that fills its grid, with consistent mass.
  test<2>("consistent",
          block_2d("box(0, 0, 1, 1)", 8)
            .with("Walls",
                  {"Left = sliding",
                   "Right = sliding",
                   "Bottom = fixed",
                   "Top = sliding"})
            .with("Loads", {"Gravity = 0; -1"})
            .with("Body body",
                  {"Points per direction = 3",
                   "Velocity = 3 * sin(2 * pi * x) * sin(pi * y); 3 * sin(pi * "
                   "x) * sin(pi * y)"})
            .with("Scheme", {"Mass = consistent"})
            .with("Solver", {"Tolerance = 1e-13"})
            .with("Time",
                  {"End = 1e3", "Maximum steps = 50", "CFL number = 0.1"}),
          1e-9);
  test<3>("3D",
          block_3d("ball(0.4, 0.4, 0.4, 0.25)", 8)
            .with("Body body", {"Velocity = 1; 2; 1"})
            .with("Time",
                  {"End = 1e3", "Maximum steps = 60", "CFL number = 0.3"}),
          1e-10);

  // In free flight, accelerations are noise, which differs from one number of
  // processes to another: no reason for other steps.
  const Text flight =
    block_2d("ball(0.2, 0.5, 0.15)", 16)
      .with("Scheme", {"Mass = consistent"})
      .with("Body body", {"Points per direction = 2", "Velocity = 1; 0"})
      .with("Material solid",
            {"Model = neo-hookean", "Density = 1000", "Young modulus = 1e4"})
      .with("Time", {"End = 0.6"});
  const auto n_steps = [&](const MPI_Comm comm) {
    Simulated<2> run(flight, comm);
    run.run();
    return run->state().n_steps;
  };
  check("steps in free flight",
        n_steps(MPI_COMM_SELF) == n_steps(MPI_COMM_WORLD));
}

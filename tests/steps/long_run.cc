// SPDX-License-Identifier: LGPL-2.1-or-later

// Some hundred steps of a beam that swings and of a pile at rest: the mass does
// not change, and nothing grows from step to step. scripts/tables long_runs has
// 100000 steps of them.
#include <greville/base/memory.h>

#include "simulation.h"

void
test(const std::string &name, const Text &text, const unsigned int n_steps)
{
  Simulated<2> run(text);
  const auto   start = run->statistics();
  // Lists and factorizations have their sizes by then.
  while (run->state().n_steps < n_steps / 2)
    run->step();
  const auto before = allocated_memory();
  while (run->state().n_steps < n_steps)
    {
      run->step();
      run->statistics();
    }
  const auto after = allocated_memory();
  const auto end   = run->statistics();
  check(name + ", mass", end.mass == start.mass);
  check(name + ", points", end.n_points == start.n_points);
  const auto energy = [](const Statistics<2> &s) {
    return s.kinetic + s.strain + s.gravitational;
  };
  check(name + ", energy", energy(end) / energy(start), 1.02);
  // Half a number for each point and step would be seen.
  if (before && after)
    check(name + ", memory",
          double(*after) - double(*before),
          4. * double(start.n_points) * (n_steps / 2));
}



// A series of measured values keeps what it needs, however often it is added
// to.
void
test_series()
{
  const MPI_Comm comm = MPI_COMM_WORLD;
  if (Utilities::MPI::this_mpi_process(comm) == 0)
    std::ofstream("series.csv") << "time,value\n0.1,0\n0.35,0\n0.3501,0\n2,0\n";
  MPI_Barrier(comm);
  ReferenceParameters parameters;
  parameters.series_file     = "series.csv";
  parameters.series_quantity = "front";
  MeasuredData<2> measured(parameters);
  MPI_Barrier(comm);
  const double       dt    = 0.0007;
  const unsigned int n     = 2000;
  const auto         value = [](const double t) { return 1. + t * t; };
  double             mean = 0., largest = 0.;
  for (const double t : {0.1, 0.35, 0.3501})
    {
      const double k = std::ceil(t / dt), a = (k - 1.) * dt, b = k * dt;
      const double expected =
        value(a) + (t - a) / (b - a) * (value(b) - value(a));
      mean += expected / 3.;
      largest = std::max(largest, expected);
    }
  for (unsigned int k = 0; k <= n; ++k)
    {
      Statistics<2> row;
      row.time  = k * dt;
      row.front = value(row.time);
      measured.add(row);
    }
  const Distance distance = measured.series_distance();
  check_range("series, compared", distance.n, 3, 3);
  check("series, mean", std::abs(distance.mean - mean), 1e-13);
  check("series, largest", std::abs(distance.largest - largest), 1e-13);
  check_range("series, kept", measured.added().first.size(), 4, 12);
}



void
test_main()
{
  const Text beam =
    block_2d("box(0, 0.25, 0.75, 0.5)", 8)
      .with("Body body",
            {"Points per direction = 3", "Velocity = 0; 0.5 * x^2"})
      .with("Walls", {"Left = fixed"})
      .with("Time", {"End = 100"});
  test("lumped", beam.with("Scheme", {"Stress update = MUSL"}), 400);
  test("consistent", beam.with("Scheme", {"Mass = consistent"}), 400);
  test("total Lagrangian",
       beam.with("Scheme",
                 {"Mass = consistent", "Formulation = total Lagrangian"}),
       400);
  test("newmark",
       beam.with("Scheme", {"Mass = consistent", "Stress update = newmark"})
         .with("Time", {"Step = 0.005"}),
       60);
  test("pile",
       block_2d("intersection(box(0, 0, 1, 0.3), half_space(1, 1, 0.9))", 8)
         .with("Body body", {"Points per direction = 3"})
         .with("Material solid",
               {"Model = drucker-prager",
                "Young modulus = 1000",
                "Friction angle = 35",
                "Cohesion = 0.2"})
         .with("Walls", {"Left = sliding", "Bottom = fixed"})
         .with("Loads", {"Gravity = 0; -10", "Cundall damping = 0.7"})
         .with("Scheme", {"Stress update = MUSL", "FLIP share = 0.975"})
         .with("Time", {"End = 100"}),
       600);
  test_series();
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks mass and momentum of a spinning and translating disk in each step, and
// the spin with APIC and interior functions. Points cross process borders.
#include "simulation.h"

template <int dim>
void
test(const std::string &name, const Text &text, const bool conserves_spin)
{
  Simulated<dim> run(text);
  auto           before = run->statistics();
  const double   L      = before.angular_momentum.norm();
  const double   P      = before.momentum.norm();
  double         mass = 0., momentum = 0., spin = 0.;
  std::uint64_t  sent        = 0;
  unsigned int   quiet_steps = 0;
  const bool     several = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;
  while (!run->is_finished())
    {
      run->step();
      const auto after = run->statistics();
      mass = std::max(mass, std::abs(after.mass / before.mass - 1.));
      momentum =
        std::max(momentum, (after.momentum - before.momentum).norm() / P);
      spin =
        std::max(spin,
                 (after.angular_momentum - before.angular_momentum).norm() / L);
      before = after;
      if (several)
        {
          const std::uint64_t now =
            Utilities::MPI::sum(run->state().n_sent, MPI_COMM_WORLD);
          quiet_steps += now == sent;
          sent = now;
        }
    }
  check(name + ", mass", mass, 1e-12);
  check(name + ", momentum", momentum, 1e-12);
  if (conserves_spin)
    check(name + ", angular momentum", spin, 1e-12);
  else
    check(name + ", angular momentum", spin, 1e-2);
  check(name + ", points go to other processes in most steps",
        !several ||
          (dim == 2 ? quiet_steps < run->state().n_steps / 2 : sent > 0));
}



void
test_main()
{
  const Text disk =
    block_2d("ball(0.5, 0.5, 0.25)", 20)
      .with("Body body",
            {"Velocity = 0.5 - 8 * (y - 0.5); 0.1 + 8 * (x - 0.5)",
             "Points per direction = 3"})
      .with("Time", {"End = 0.1", "Step = 0.001"});
  // APIC's points begin with the gradient of their velocity: a stiff body that
  // spins keeps its energy, of which 3 % are those of the matrices.
  {
    Simulated<2> run(disk.with("Scheme", {"Transfer = APIC"}));
    const double start = run->statistics().kinetic;
    run->step();
    run->step();
    const auto end = run->statistics();
    check("APIC, energy",
          std::abs((end.kinetic + end.strain) / start - 1.),
          2e-3);
  }
  for (const unsigned int p : {2, 3})
    {
      const Text order = disk.with("Grid", {"Order = " + std::to_string(p)});
      test<2>("order " + std::to_string(p) + ", APIC",
              order.with("Scheme", {"Transfer = APIC"}),
              true);
      test<2>("order " + std::to_string(p) + ", FLIP, MUSL",
              order.with("Scheme", {"Stress update = MUSL"}),
              false);
      for (const std::string scheme : {"USL", "MUSL"})
        test<2>("order " + std::to_string(p) + ", Taylor, " + scheme,
                order.with("Scheme",
                           {"Transfer = Taylor", "Stress update = " + scheme}),
                false);
      test<2>("order " + std::to_string(p) + ", APIC, MUSL",
              order.with("Scheme", {"Transfer = APIC", "Stress update = MUSL"}),
              true);
    }
  test<2>("fmpm-2", disk.with("Scheme", {"Mass = fmpm-2"}), false);
  test<3>("ball, APIC",
          block_3d("ball(0.5, 0.5, 0.5, 0.2)", 12)
            .with("Body body",
                  {"Velocity = 0.5 - 8 * (y - 0.5); 8 * (x - 0.5); 0.3"})
            .with("Time", {"End = 0.03", "Step = 0.001"})
            .with("Scheme", {"Transfer = APIC"}),
          true);
}

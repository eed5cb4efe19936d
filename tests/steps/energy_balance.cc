// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks the energy balance of damped bodies: the counted work of damping
// equals its effect in a step. The balance therefore closes, and the guard
// detects spurious energy even if damping removes it again.
#include "simulation.h"

namespace
{
  const MPI_Comm    world   = MPI_COMM_WORLD;
  const std::string cundall = "Cundall damping = 0.5";

  // Neo-Hookean, whose stress is the derivative of an energy.
  Text
  column(const std::string &mass)
  {
    return block_2d("box(0, 0, 1, 1)", 4)
      .with("Walls", {"Left = sliding", "Right = sliding", "Bottom = sliding"})
      .with("Loads", {"Gravity = 0; -0.1", cundall})
      .with("Scheme", {"Mass = " + mass})
      .with("Time", {"End = 3", "Step = 0.002"})
      .with("Material solid", {"Model = neo-hookean", "Poisson ratio = 0"});
  }



  // The work of damping while a column comes to rest under its weight, and what
  // its energy loses beyond that.
  std::pair<double, double>
  settle(const Text &text, const MPI_Comm comm = world)
  {
    Simulated<2> run(text, comm);
    run.run();
    const auto   s       = run->statistics();
    const double damping = run->state().energy.damping(comm);
    return {damping,
            run->state().energy.work(comm) + damping - s.kinetic - s.strain};
  }



  // Whether the guard warns of a column that vibrates, is damped, and gets half
  // of its initial velocity again where it has come to rest.
  bool
  guard_warns(const bool is_kicked)
  {
    constexpr unsigned int kick_every = 250;
    Simulated<2>           run(column("consistent")
                       .with("Body body", {"Velocity = 0; 0.01 * y"})
                       .with("Loads", {"Gravity = 0; 0"})
                       .with("Scheme", {"Energy gain = warn"})
                       .with("Time", {"Step = 0.004"}));
    const double           start   = run->statistics().kinetic;
    double                 largest = start;
    while (!run->is_finished())
      {
        if (is_kicked && run->state().n_steps % kick_every == kick_every - 1)
          for (auto &body : run->bodies())
            body.points.for_each([&](const unsigned int, const auto p) {
              p.velocity(1) += 0.005 * p.position(1);
            });
        run->step();
        const auto s = run->statistics();
        largest      = std::max(largest, s.kinetic + s.strain);
      }
    check("no more energy than initially", largest / start - 1., 0.01);
    for (const std::string &warning : run->step_log().take_warnings())
      if (warning.find("energy has come from nothing") != std::string::npos)
        return true;
    return false;
  }
} // namespace



void
test_main()
{
  // A block that is thrown up stays stress-free, and damping brakes it by
  // alpha g on its way up and down.
  for (const std::string mass : {"lumped", "fmpm-4", "consistent"})
    for (const std::string transfer : {"FLIP", "PIC", "APIC"})
      for (const std::string order : {"USL", "MUSL"})
        for (const std::string share : {"1", "0.9"})
          {
            if ((transfer == "APIC" && mass != "lumped") ||
                (transfer != "FLIP" && share != "1"))
              continue;
            Simulated<2> run(block_2d("box(0.25, 0.25, 0.75, 0.5)")
                               .with("Body body", {"Velocity = 0; 0.1"})
                               .with("Loads", {"Gravity = 0; -1", cundall})
                               .with("Time", {"End = 0.2", "Step = 0.002"})
                               .with("Scheme",
                                     {"Mass = " + mass,
                                      "Transfer = " + transfer,
                                      "FLIP share = " + share,
                                      "Stress update = " + order}));
            const double m     = run->statistics().mass;
            double       error = 0., last = 0.1, taken = 0.;
            while (!run->is_finished())
              {
                const double dt = run->state().n_steps == 0 ? 0.001 : 0.002;
                run->step();
                const double v = run->statistics().momentum[1] / m;
                taken += 0.5 * m * dt * (last > 0. ? 0.5 : -0.5) * (last + v);
                last  = v;
                error = std::max(error,
                                 std::abs(run->state().energy.damping(world) +
                                          taken));
              }
            check(mass + ", " + transfer + " " + share + ", " + order +
                    ": work of damping in a flight",
                  error / taken,
                  1e-10);
          }

  // Forces and damping brake dust, whose velocity is not uniform: damping with
  // the factor 1/2 takes a third of what FLIP loses.
  {
    Simulated<2> run(
      block_2d("box(0.25, 0.25, 0.75, 0.75)")
        .with("Material solid", {"Young modulus = 1e-12"})
        .with("Body body", {"Velocity = 0.1 + 0.5 * x * y; 0.2 + x^2"})
        .with("Loads", {"Body force = -1 - x; -1 - 5 * x * y", cundall})
        .with("Time", {"End = 0.05", "Step = 0.002"}));
    const double start = run->statistics().kinetic;
    run.run();
    const double lost  = start - run->statistics().kinetic;
    const double taken = -run->state().energy.damping(world);
    check("work of damping on dust", std::abs(3. * taken / lost - 1.), 1e-10);
  }

  // The balance closes up to what the scheme itself takes or gives, with lumped
  // mass more than with others, and is the same on any number of processes.
  const std::vector<std::pair<std::string, double>> bounds = {
    {"lumped", 0.05}, {"fmpm-4", 0.005}, {"consistent", 0.002}};
  for (const auto &[mass, bound] : bounds)
    {
      const Text text = column(mass).with("Solver", {"Tolerance = 1e-11"});
      const auto all  = settle(text);
      const auto own  = settle(text, MPI_COMM_SELF);
      check(mass + ": takes energy", all.first < 0.);
      check(mass + ": balance", std::abs(all.second / all.first), bound);
      check(mass + ": processes", std::abs(all.first / own.first - 1.), 1e-9);
    }

  // Energy that damping takes does not hide a gain without a source.
  check("the guard sees kicks", guard_warns(true));
  check("no kicks, no warning", !guard_warns(false));

  // Damping that gives energy back is no source of it.
  EnergyBalance energy;
  energy.reinit(10., 1e-12);
  const double n = Utilities::MPI::n_mpi_processes(world);
  energy.add_damping(-6. / n);
  check("taken", std::abs(energy.gain(energy.totals(4., world))), 1e-14);
  energy.add_damping(3. / n);
  check("given back",
        std::abs(energy.gain(energy.totals(7., world)) - 0.3),
        1e-14);
}

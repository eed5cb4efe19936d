// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks rows that a step sums up for the time at which it begins. If the same
// forces act before and after this time, they agree to round-off with rows of
// finished states, which include half of a kick. Wall impacts act within one
// step: the rows then differ by up to two per cent, and so much of the energy
// balance stays open. With SHOW in the environment, it prints the columns that
// differ most.
#include <greville/steps/coupled_simulations.h>

#include "simulation.h"

namespace
{
  using Columns = std::vector<std::pair<std::string, double>>;

  /// Return the difference of energy and work.
  double
  open_balance(const Columns &row)
  {
    double sum = 0.;
    for (const auto &[name, value] : row)
      if (name == "kinetic" || name == "strain" || name == "dissipation")
        sum += value;
      else if (name.compare(0, 5, "work_") == 0)
        sum -= value;
    return sum;
  }



  struct Differences
  {
    std::map<std::string, double> largest; // over the largest value
    double                        late = 0., finished = 0.; // open balances

    double
    worst() const
    {
      double result = 0.;
      for (const auto &column : largest)
        result = std::max(result, column.second);
      return result;
    }
  };

  template <int dim>
  Differences
  compare(const Text &text, const unsigned int n_steps)
  {
    CoupledSimulations<dim>       simulations(text.parse());
    std::map<std::string, double> sizes;
    Differences                   result;
    double                        start = 0., energy = 0.;
    for (unsigned int k = 0; k < n_steps; ++k)
      {
        const auto state = simulations.state();
        const bool lags  = simulations.rows_are_late();
        simulations.finish();
        const Columns finished = simulations.statistics().columns();
        simulations.set_state(state);
        simulations.ask_for_row();
        simulations.step();
        if (!lags)
          {
            start = open_balance(finished);
            continue;
          }
        const Columns late = simulations.late_statistics().columns();
        for (unsigned int c = 0; c < late.size(); ++c)
          {
            const std::string &name = late[c].first;
            // Components of vectors have the size of the vector.
            const std::string size =
              name.find("momentum") == 0           ? "momentum"
              : name.find("angular_momentum") == 0 ? "angular_momentum"
              : name.find("work") == 0 || name == "total" || name == "strain" ||
                  name == "dissipation" || name == "gravitational"
                ? "kinetic"
                : name;
            sizes[size] = std::max(sizes[size], std::abs(finished[c].second));
            result.largest[size] =
              std::max(result.largest[size],
                       std::abs(late[c].second - finished[c].second));
            if (name == "kinetic" || name == "strain")
              energy = std::max(energy, finished[c].second);
          }
        result.late =
          std::max(result.late, std::abs(open_balance(late) - start));
        result.finished =
          std::max(result.finished, std::abs(open_balance(finished) - start));
      }
    for (auto &[name, value] : result.largest)
      if (sizes[name] > 0.)
        value /= sizes[name];
    result.late /= energy;
    result.finished /= energy;
    return result;
  }

  void
  show(const std::string &name, const Differences &found)
  {
    if (!std::getenv("SHOW"))
      return;
    print() << name << ": open " << found.late << " (late), " << found.finished
            << " (finished)";
    for (const auto &[column, value] : found.largest)
      if (value > 1e-12)
        print() << ", " << column << ' ' << value;
    print() << std::endl;
  }



  template <int dim = 2>
  void
  check_same(const std::string &name,
             const Text        &text,
             const double       tolerance = 1e-10)
  {
    const Differences found = compare<dim>(text, 12);
    check(name + ": late rows are those of finished states",
          found.worst(),
          tolerance);
    show(name, found);
  }

  void
  check_close(const std::string &name, const Text &text)
  {
    const auto run = [&](const std::string &step, const unsigned int n) {
      return compare<2>(text.with("Time", {"End = 1", "Step = " + step}), n);
    };
    const Differences large = run("0.001", 60), small = run("0.0005", 120);
    check(name + ": differences", small.worst(), 0.03);
    check(name + ": the balance of late rows is that of finished states",
          small.late < 1.1 * small.finished + 1e-3);
    show(name + ", dt", large);
    show(name + ", dt / 2", small);
  }
} // namespace



void
test_main()
{
  // Free bodies, with loads that do not depend on time.
  const Text free = block_2d("ball(0.5, 0.5, 0.2)", 12)
                      .with("Grid", {"Order = 2"})
                      .with("Material solid", {"Model = neo-hookean"})
                      .with("Body body", {"Velocity = 0.3 - y; x"})
                      .with("Solver", {"Tolerance = 1e-13"})
                      .with("Loads", {"Gravity = 0; -1"})
                      .with("Time", {"End = 1", "Step = 0.001"});
  for (const std::string scheme : {"USL", "MUSL"})
    {
      const Text text = free.with("Scheme", {"Stress update = " + scheme});
      check_same(scheme + ", FLIP", text.with("Scheme", {"Mass = lumped"}));
      check_same(scheme + ", consistent",
                 text.with("Scheme", {"Mass = consistent", "Filter = 0"}));
    }
  check_same("total Lagrangian",
             free.with("Scheme",
                       {"Mass = consistent",
                        "Formulation = total Lagrangian"}));
  check_same("load on points",
             free.with("Scheme", {"Mass = lumped"})
               .with("Loads", {"Body force = 1; 2"}));
  check_same<3>("3D",
                block_3d("ball(0.5, 0.5, 0.5, 0.2)", 8)
                  .with("Body body", {"Velocity = 0.3 - y; x; z"})
                  .with("Scheme", {"Mass = lumped"})
                  .with("Time", {"End = 1", "Step = 0.001"}),
                1e-10);

  const Text ball =
    block_2d("ball(0.4, 0.26, 0.21)", 12)
      .with("Grid", {"Order = 2"})
      .with("Body body", {"Velocity = 3; -4", "Points per direction = 3"})
      .with("Material solid", {"Model = neo-hookean"})
      .with("Loads", {"Gravity = 0; -9"})
      .with("Walls",
            {"Bottom = friction", "Bottom friction = 0.3", "Left = sliding"});
  for (const std::string mass : {"lumped", "consistent"})
    {
      const Text text = with_mass(ball, mass);
      check_close("floor, " + mass, text);
      check_close("damping, " + mass,
                  text.with("Loads", {"Cundall damping = 0.2"}));
      check_close(
        "piston, " + mass,
        text.with("Simulation", {"Rigid bodies = piston", "Contacts = push"})
          .with("Rigid body piston",
                {"Shape = box(0.7, 0, 0.85, 1)",
                 "Velocity = 1 + cos(9 * t); 0"})
          .with("Contact push", {"Bodies = body, piston"}));
    }
  check_close("APIC", ball.with("Scheme", {"Transfer = APIC"}));
  check_close("two grids",
              ball.with("Simulation", {"Bodies = body, other"})
                .with("Body other",
                      {"Material = solid",
                       "Shape = box(0.3, 0.3, 0.7, 0.8)",
                       "Velocity = -2; 1"})
                .with("Grid", {"Per body = true"})
                .with("Walls", {"Bottom = fixed", "Bottom friction = 0"})
                .with("Scheme",
                      {"Mass = consistent", "Formulation = total Lagrangian"}));
}

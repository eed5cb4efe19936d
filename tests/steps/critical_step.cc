// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks the critical step: Courant numbers of full boxes against eigenvalues
// of assembled matrices, and stability on both sides of it.
#include "simulation.h"

Text
full_box(const unsigned int p, const std::string &mass)
{
  return block_2d("box(0, 0, 1, 1)", 16)
    .with("Grid", {"Order = " + std::to_string(p)})
    .with("Scheme", {"Mass = " + mass})
    .with("Body body", {"Points per direction = 3"})
    .with("Time", {"End = 1e-9", "Step = 1e-9", "Too large step = warn"});
}



void
test_main()
{
  // lambda + 2 G of E = 100, nu = 0.3, rho = 1
  const double c       = std::sqrt(100. * 0.7 / (1.3 * 0.4));
  const auto   courant = [&](const Text &text) {
    Simulated<2> run(text);
    run->step();
    return run->state().estimates.critical * 16. * c;
  };
  const auto between = [&](const std::string &name,
                           const double       value,
                           const double       lower,
                           const double       upper) {
    check(name, value >= lower && value <= upper);
    if (!(value >= lower && value <= upper))
      print() << value << std::endl;
  };
  // M_L^-1 K alone has 0.81; USL and MUSL take the mapping into account.
  const auto lumped = [&](const std::string &order) {
    return courant(
      full_box(2, "lumped").with("Scheme", {"Stress update = " + order}));
  };
  between("lumped, p = 2, USL", lumped("USL"), 0.57, 0.75);
  check("lumped, p = 2, MUSL", lumped("MUSL") > 0.81);
  // Without extension open knots have outliers, with it they have none.
  const auto consistent = [&](const unsigned int p,
                              const std::string &threshold) {
    return courant(full_box(p, "consistent")
                     .with("Scheme", {"Filling threshold = " + threshold}));
  };
  between("consistent, p = 2, raw: 0.32", consistent(2, "0"), 0.29, 0.35);
  between("consistent, p = 3, raw: 0.19", consistent(3, "0"), 0.17, 0.21);
  between("consistent, p = 2: 0.57", consistent(2, "0.45"), 0.54, 0.6);
  between("consistent, p = 3: 0.37", consistent(3, "0.45"), 0.34, 0.4);

  // Viscosity shortens the step.
  const auto fluid = [&](const std::string &viscosity) {
    Text text = full_box(2, "lumped");
    text.content =
      text.content.substr(0, text.content.find("subsection Material"));
    return courant(
      text
        .add("Material solid",
             {"Model = newtonian-fluid",
              "Density = 1",
              "Sound speed = 11.6",
              "Viscosity = " + viscosity})
        .add("Time", {"End = 1e-9", "Step = 1e-9", "Too large step = warn"}));
  };
  check("viscosity", fluid("1") < 0.8 * fluid("0"));

  // Twice the viscosity of shear or of volume where it alone counts: half the
  // step. A stiff body beside a viscous one has its own.
  const auto viscous = [&](const std::vector<std::string> &lines) {
    Text text = full_box(2, "lumped");
    text.content =
      text.content.substr(0, text.content.find("subsection Material"));
    text.add("Material solid",
             {"Model = newtonian-fluid", "Density = 1", "Sound speed = 0.01"});
    text.add("Time", {"End = 1e-9", "Step = 1e-9", "Too large step = warn"});
    return courant(text.with("Material solid", lines));
  };
  between("twice the viscosity",
          viscous({"Viscosity = 2"}) / viscous({"Viscosity = 1"}),
          0.49,
          0.51);
  between("twice the bulk viscosity",
          viscous({"Viscosity = 0", "Bulk viscosity = 2"}) /
            viscous({"Viscosity = 0", "Bulk viscosity = 1"}),
          0.49,
          0.51);
  const auto mud_and_steel = [&](const bool with_mud, const bool with_steel) {
    const std::string bodies = with_mud && with_steel ? "mud, steel"
                               : with_mud             ? "mud"
                                                      : "steel";
    Text              text;
    text.add("Simulation", {"Bodies = " + bodies, "Materials = " + bodies})
      .add("Grid", {"Cells = 16, 16"})
      .add("Scheme", {"Mass = lumped"})
      .add("Time", {"End = 1e-20", "Step = 1e-20", "Too large step = warn"});
    if (with_mud)
      text.add("Body mud", {"Material = mud", "Shape = box(0, 0, 0.5, 0.5)"})
        .add("Material mud",
             {"Model = bingham",
              "Density = 1500",
              "Sound speed = 20",
              "Plastic viscosity = 0.1",
              "Yield stress = 100",
              "Regularization = 1"});
    if (with_steel)
      text
        .add("Body steel",
             {"Material = steel", "Shape = box(0.7, 0.7, 0.9, 0.9)"})
        .add("Material steel",
             {"Model = neo-hookean",
              "Density = 7800",
              "Young modulus = 2e11",
              "Poisson ratio = 0.3"});
    return courant(text);
  };
  const double mud   = mud_and_steel(true, false),
               steel = mud_and_steel(false, true);
  check("steel is stiffer", steel < 0.1 * mud);
  between("mud and steel", mud_and_steel(true, true) / steel, 0.95, 1.05);

  // On both sides of it: a small disturbance stays small, or grows.
  const auto test_stability =
    [&](const std::string &name, const Text &box, const double unstable) {
      Simulated<2> first(box);
      first->step();
      const double limit         = first->state().estimates.critical;
      const auto   largest_speed = [&](const double part) {
        std::ostringstream step;
        step.precision(12);
        step << part * limit;
        Simulated<2> run(
          box
            .with("Body body",
                  {"Velocity = 1e-6 * sin(50 * x * y); 1e-6 * cos(30 * x)"})
            .with("Time",
                  {"End = 1e3",
                   "Maximum steps = 150",
                   "Step = " + step.str(),
                   "Too large step = ignore"})
            // Near the limit, energies of different times differ much.
            .with("Scheme", {"Energy gain = ignore"}));
        try
          {
            run.run();
          }
        catch (const std::exception &)
          {
            return 1.;
          }
        return run->statistics().largest_speed;
      };
      check(name + ", 0.95 of the critical step is stable",
            largest_speed(0.95),
            1e-4);
      check(name + ", a longer step is not", largest_speed(unstable) > 1e-4);
    };
  for (const std::string mass : {"fmpm-3", "consistent"})
    test_stability(mass, full_box(2, mass), 1.3);
  for (const unsigned int p : {1, 2, 3})
    for (const std::string update : {"USL", "MUSL"})
      for (const std::string transfer : {"FLIP", "PIC", "APIC", "Taylor"})
        test_stability(
          "p = " + std::to_string(p) + ", " + update + ", " + transfer,
          full_box(p, "lumped")
            .with("Grid", {"Cells = 8, 8"})
            .with("Scheme",
                  {"Stress update = " + update, "Transfer = " + transfer}),
          1.3);
  test_stability("half FLIP",
                 full_box(2, "lumped")
                   .with("Scheme",
                         {"Stress update = MUSL", "FLIP share = 0.5"}),
                 1.3);

  // The effect of the parameter.
  const auto outcome = [&](const std::string &what, const std::string &step) {
    Simulated<2> run(full_box(2, "lumped")
                       .with("Time",
                             {"End = 1",
                              "Maximum steps = 1",
                              "Step = " + step,
                              "Too large step = " + what}));
    try
      {
        run->step();
      }
    catch (const std::exception &)
      {
        return std::string("refused");
      }
    return std::string(run->step_log().take_warnings().empty() ? "silent"
                                                               : "warned");
  };
  check("refuse", outcome("refuse", "1") == "refused");
  check("warn", outcome("warn", "1") == "warned");
  check("ignore", outcome("ignore", "1") == "silent");
  check("a small step is not refused",
        outcome("refuse", "0.5 * h / 12 / p") == "silent");

  // Automatic steps: both factors.
  const auto automatic = [&](const std::string &cfl,
                             const std::string &safety) {
    Simulated<2> run(
      full_box(2, "consistent")
        .with(
          "Time",
          {"End = 1", "Step =", "CFL number = " + cfl, "Safety = " + safety}));
    run->step();
    return run->state().step * 16. * c;
  };
  between("CFL number", automatic("0.1", "1"), 0.0999, 0.1001);
  between("safety", automatic("1", "0.5"), 0.27, 0.3);

  // A body that leaves the lines of the grid: its critical step falls. It is
  // estimated at the start only; accelerations show that the step has
  // become too long. The same step, given, is not stable.
  const auto first_estimate_only = [](SimulationParameters &parameters) {
    parameters.time.estimate_every = 0;
  };
  const Text moving =
    block_2d("box(0.25, 0.25, 0.75, 0.75)", 8)
      .with("Scheme", {"Mass = consistent"})
      .with("Body body",
            {"Points per direction = 2",
             "Velocity = 0.5 + 1e-3 * sin(20 * x); 0.3 + 1e-3 * cos(30 * y)"})
      .with("Time", {"End = 0.5", "CFL number = 2", "Safety = 0.9"});
  Simulated<2> automatic_run(moving, first_estimate_only);
  automatic_run->step();
  std::ostringstream first_step;
  first_step << automatic_run->state().step;
  const double energy = automatic_run->statistics().kinetic;
  automatic_run.run();
  check("automatic steps: energy",
        std::abs(automatic_run->statistics().kinetic / energy - 1.),
        1e-3);
  bool is_stable = true;
  try
    {
      Simulated<2> given(
        moving.with("Time",
                    {"Step = " + first_step.str(), "Too large step = ignore"}));
      given.run();
      is_stable = given->statistics().kinetic < 2. * energy;
    }
  catch (const std::exception &)
    {
      is_stable = false;
    }
  check("the first one, given", !is_stable);

  // A viscous blob that has torn keeps its viscosity, but not its stiffness: it
  // loses energy all the time.
  for (const std::string mass : {"lumped", "consistent"})
    {
      Simulated<2> blob(
        Text()
          .add("Simulation", {"Bodies = blob", "Materials = goo"})
          .add("Grid", {"Cells = 20, 20"})
          .add("Scheme", {"Mass = " + mass})
          .add("Time", {"End = 0.15"})
          .add("Body blob",
               {"Material = goo",
                "Shape = ball(0.5, 0.5, 0.15)",
                "Points per direction = 3",
                "Velocity = 8 * (x - 0.5); 8 * (y - 0.5) + 0.01 * sin(60 * "
                "x)"})
          .add("Material goo",
               {"Model = newtonian-fluid",
                "Density = 1000",
                "Sound speed = 20",
                "Viscosity = 200"}));
      double last = blob->statistics().kinetic, rise = 0.;
      try
        {
          while (!blob->is_finished())
            {
              blob->step();
              const double kinetic = blob->statistics().kinetic;
              rise                 = std::max(rise, kinetic / last - 1.);
              last                 = kinetic;
            }
        }
      catch (const std::exception &)
        {
          rise = 1.;
        }
      check("torn blob, " + mass, rise, 1e-10);
    }

  // Water hits a wall at half of its speed of sound and gets stiffer: the step
  // is estimated again, though only the first one was asked for.
  Simulated<2> impact(
    Text()
      .add("Simulation", {"Bodies = water", "Materials = water"})
      .add("Grid", {"Cells = 16, 16"})
      .add("Scheme", {"Mass = lumped"})
      .add("Walls", {"Left = sliding", "Bottom = sliding", "Top = sliding"})
      .add("Time", {"End = 0.02"})
      .add("Body water",
           {"Material = water",
            "Shape = box(0, 0, 0.5, 1)",
            "Points per direction = 2",
            "Velocity = -5; 0"})
      .add("Material water",
           {"Model = newtonian-fluid", "Density = 1000", "Sound speed = 10"}),
    first_estimate_only);
  impact->step();
  const double at_rest = impact->state().estimates.critical;
  impact.run();
  check("impact: critical step",
        impact->state().estimates.critical < 0.8 * at_rest);

  // Crushed cells of a block of metal bound the steps (runs/crushed_block).
  std::string message;
  try
    {
      Simulated<2> crushed(
        Text()
          .add("Simulation", {"Bodies = block", "Materials = metal"})
          .add("Grid", {"Upper corner = 0.02, 0.016", "Cells = 20, 16"})
          .add("Scheme", {"Mass = lumped", "Formulation = total Lagrangian"})
          .add("Walls", {"Bottom = sliding"})
          .add("Time", {"End = 1.5e-5"})
          .add("Body block",
               {"Material = metal",
                "Shape = box(0.006, 0, 0.014, 0.012)",
                "Velocity = 0; -300"})
          .add("Material metal",
               {"Model = von-mises",
                "Density = 8930",
                "Young modulus = 117e9",
                "Poisson ratio = 0.35",
                "Yield stress = 400e6"}),
        [](SimulationParameters &parameters) {
          parameters.time.smallest_step = 0.7;
        });
      crushed.run();
    }
  catch (const std::exception &error)
    {
      message = message_of(error);
    }
  check("crushed cells: the smallest step",
        message.find("below 0.7 of the first one") != std::string::npos &&
          message.find("the most crushed cell bounds the step") !=
            std::string::npos);
}

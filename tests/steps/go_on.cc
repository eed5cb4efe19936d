// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks a program that catches the error of a step and continues: its results
// are the same as without the error, because all data that a step passes on
// return to the last good state.
#include <greville/steps/coupled_simulations.h>

#include "simulation.h"

namespace
{
  constexpr unsigned int n_steps = 58;

  /// All numbers of all points of this process, in their order, and what else
  /// the next step depends on.
  std::vector<double>
  numbers(const Simulation<2> &simulation)
  {
    std::vector<double> result = {simulation.state().time,
                                  simulation.state().step,
                                  simulation.state().estimates.critical,
                                  double(simulation.state().n_steps)};
    for (const Body<2> &body : simulation.bodies())
      body.points.for_each([&](const unsigned int, const auto p) {
        for (unsigned int k = 0; k < body.points.layout().size; ++k)
          result.push_back(p[k]);
      });
    return result;
  }



  /// One step that fails: the position of a point is NaN, or outside of the
  /// grid.
  void
  fail(Simulation<2> &simulation, const std::string &reason)
  {
    const unsigned int n_before = simulation.state().n_steps;
    simulation.bodies()[0].points.for_each(
      [&](const unsigned int, const auto p) {
        p.velocity(0) = reason == "NaN" ? std::nan("") : 1e6;
      });
    std::string message;
    try
      {
        simulation.step();
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    check("the step fails", message.rfind("Step ", 0) == 0);
    check("back to a good state",
          double(simulation.state().n_steps),
          double(n_before));
  }



  enum class Error
  {
    none,
    none_but_copy,
    caught_with_copy,
    caught
  };

  /// Steps to n_steps. In the middle, an error: the simulation goes back to the
  /// state that it has kept, or the program to a copy; or it goes on from the
  /// copy without an error.
  std::unique_ptr<Simulated<2>>
  run(const Text &text, const Error error)
  {
    auto  simulated  = std::make_unique<Simulated<2>>(text);
    auto &simulation = simulated->simulation;
    while (simulation.state().n_steps < 55)
      simulation.step();
    const State<2> good = simulation.state();
    if (error == Error::caught_with_copy)
      fail(simulation, "NaN");
    if (error == Error::caught)
      fail(simulation, "far away");
    if (error == Error::none_but_copy || error == Error::caught_with_copy)
      simulation.set_state(good);
    while (simulation.state().n_steps < n_steps)
      simulation.step();
    return simulated;
  }



  /// With a copy, all numbers have the same bits as without the error, unless
  /// factorizations @p are_kept: then as with a copy and without an error.
  void
  test(const std::string &what, const Text &text, const bool are_kept)
  {
    std::map<Error, std::vector<double>> sums, all;
    for (const Error error : {Error::none,
                              Error::none_but_copy,
                              Error::caught_with_copy,
                              Error::caught})
      {
        const auto          simulated = run(text, error);
        const Statistics<2> row       = simulated->simulation.statistics();
        sums[error]                   = {row.time,
                                         row.step,
                                         simulated->simulation.state().estimates.critical,
                                         row.kinetic,
                                         row.strain,
                                         row.center[0]};
        all[error]                    = numbers(simulated->simulation);
      }
    check(what + ", same bits from a copy",
          all[Error::caught_with_copy] == all[Error::none_but_copy] &&
            (are_kept || all[Error::caught_with_copy] == all[Error::none]));
    // Copies that the simulation keeps have some numbers in single precision.
    for (const Error error : {Error::caught_with_copy, Error::caught})
      for (unsigned int k = 0; k < sums[error].size(); ++k)
        check(what,
              std::abs(sums[error][k] / sums[Error::none][k] - 1.),
              error == Error::caught ? 1e-5 : 1e-7);
  }



  // Integrators that cannot be made: so many can, and then one cannot.
  int n_makes = 1000;

  /// Two bodies with a grid each enter a stage, which fails for the second one:
  /// both are in the stage before, and go on as if nothing had happened.
  void
  test_stages()
  {
    add_time_integrator<2>("sometimes", [](const IntegratorParts<2> &parts) {
      AssertThrow(n_makes-- != 0, ExcMessage("no integrator now"));
      return make_time_integrator<2>("USL", parts);
    });
    Text text =
      block_2d("box(0.1, 0.1, 0.4, 0.4)", 10)
        .with("Simulation", {"Bodies = body, other", "Stages = one, two"})
        .with("Body body", {"Velocity = y; -0.5 * x"})
        .with("Body other",
              {"Material = solid",
               "Shape = box(0.5, 0.5, 0.8, 0.8)",
               "Velocity = x; y"})
        .with("Grid", {"Per body = true"})
        .with("Scheme", {"Formulation = total Lagrangian"})
        .with("Time", {"Step = 0.001"});
    for (const std::string stage : {"one", "two"})
      text.content +=
        "subsection Stage " + stage +
        "\nsubsection Time\nset End = " + (stage == "one" ? "0.01" : "0.02") +
        "\nend\nsubsection Scheme\nset Stress update = " +
        (stage == "one" ? "USL" : "sometimes") + "\nend\nend\n";
    const SimulationParameters parameters = text.parse();
    std::vector<Statistics<2>> ends;
    for (const bool fails : {false, true})
      {
        CoupledSimulations<2>       simulations(parameters, MPI_COMM_WORLD);
        const std::vector<State<2>> begin  = simulations.state();
        const auto                  are_at = [&](const unsigned int n_steps,
                                const unsigned int stage) {
          bool result = true;
          for (unsigned int k = 0; k < 2; ++k)
            result = result && simulations.part(k).state().n_steps == n_steps &&
                     simulations.part(k).state().stage == stage;
          return result;
        };
        const auto message_of_action = [&](const auto &action) {
          std::string message;
          n_makes = 1;
          try
            {
              action();
            }
          catch (const std::exception &error)
            {
              message = message_of(error);
            }
          n_makes = 1000;
          return message;
        };
        while (!simulations.first().is_stage_finished())
          simulations.step();
        if (fails)
          check("a stage that cannot be entered",
                message_of_action([&]() {
                  simulations.step();
                }).find("no integrator now") != std::string::npos &&
                  are_at(10, 0));
        while (!simulations.is_finished())
          simulations.step();
        ends.push_back(simulations.statistics());
        if (!fails)
          continue;
        const std::vector<State<2>> end = simulations.state();
        simulations.set_state(begin);
        check("a state of another stage", are_at(0, 0));
        check("a state whose stage cannot be entered",
              message_of_action([&]() {
                simulations.set_state(end);
              }).find("no integrator now") != std::string::npos &&
                are_at(0, 0));
        simulations.set_state(end);
        check("another stage again", are_at(20, 1));
      }
    const auto a = ends[0].values(), b = ends[1].values();
    double     difference = 0.;
    for (unsigned int k = 0; k < a.size(); ++k)
      difference =
        std::max(difference, std::abs(a[k] - b[k]) / (1. + std::abs(a[k])));
    check("goes on as if the stage had not failed", difference, 1e-6);
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
  for (const std::string order : {"USL", "MUSL"})
    test(order, text.with("Scheme", {"Stress update = " + order}), false);
  test("FMPM", text.with("Scheme", {"Mass = fmpm-3"}), false);
  for (const std::string transfer : {"APIC", "Taylor"})
    test(transfer, text.with("Scheme", {"Transfer = " + transfer}), false);
  test("consistent",
       text.with("Scheme", {"Mass = consistent"})
         .with("Walls", {"Bottom = sliding", "Bottom friction = 0"})
         .with("Solver", {"Tolerance = 1e-10"}),
       true);
  test_stages();
}

// A program that catches the error of a step and goes on gets what it had got
// without the error: all that a step hands to the next one goes back to the
// last good state.
#include "simulation.h"

namespace
{
  constexpr unsigned int n_steps = 58;

  /**
   * All numbers of all points of this process, in their order, and what else
   * the next step depends on.
   */
  std::vector<double>
  numbers(const Simulation<2> &simulation)
  {
    std::vector<double> result = {simulation.time(),
                                  simulation.last_step(),
                                  simulation.critical(),
                                  double(simulation.n_steps())};
    for (const Body<2> &body : simulation.bodies())
      body.points.for_each([&](const unsigned int, const auto p) {
        for (unsigned int k = 0; k < body.points.layout().size; ++k)
          result.push_back(p[k]);
      });
    return result;
  }



  /**
   * One step that fails: a point is no number, or has left the grid.
   */
  void
  fail(Simulation<2> &simulation, const std::string &reason)
  {
    const unsigned int n_before = simulation.n_steps();
    simulation.bodies()[0].points.for_each(
      [&](const unsigned int, const auto p) {
        p.velocity(0) = reason == "no number" ? std::nan("") : 1e6;
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
          double(simulation.n_steps()),
          double(n_before));
  }



  /**
   * Steps to n_steps, with an error in the step after @p failing (none for 0),
   * from which the simulation itself goes back, or the program with a copy of
   * the state.
   */
  std::unique_ptr<Simulated<2>>
  run(const Text &text, const unsigned int failing, const bool with_copy)
  {
    auto  simulated  = std::make_unique<Simulated<2>>(text);
    auto &simulation = simulated->simulation;
    while (simulation.n_steps() < failing)
      simulation.step();
    if (failing > 0)
      {
        const State<2> good = simulation.state();
        fail(simulation, with_copy ? "no number" : "far away");
        if (with_copy)
          simulation.set_state(good);
      }
    while (simulation.n_steps() < n_steps)
      simulation.step();
    return simulated;
  }



  /**
   * The largest relative difference of sums, and whether all numbers are the
   * same to the bit.
   */
  void
  test(const std::string &what,
       const Text        &text,
       const bool         same_bits,
       const double       tolerance)
  {
    std::vector<std::vector<double>> sums, all;
    for (const unsigned int kind : {0, 1, 2})
      {
        const auto simulated    = run(text, kind == 0 ? 0 : 55, kind == 1);
        const Statistics<2> row = simulated->simulation.statistics();
        sums.push_back({row.time,
                        row.step,
                        simulated->simulation.critical(),
                        row.kinetic,
                        row.strain,
                        row.center[0]});
        all.push_back(numbers(simulated->simulation));
      }
    if (same_bits)
      check(what + ", from a copy: same bits", all[1] == all[0]);
    for (const unsigned int kind : {1, 2})
      for (unsigned int k = 0; k < sums[0].size(); ++k)
        check(what + (kind == 1 ? ", from a copy" : ", by itself"),
              std::abs(sums[kind][k] - sums[0][k]) / std::abs(sums[0][k]),
              kind == 1 && same_bits ? 0. : tolerance);
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const Text                       text =
    block_2d("box(0.2, 0, 0.6, 0.4)", 10)
      .with("Body body", {"Velocity = 1; -0.5 * y"})
      .with("Loads", {"Gravity = 0; -20"})
      .with("Walls", {"Bottom = friction", "Bottom friction = 0.3"})
      .with("Time", {"End = 10", "Estimate every = 7"});
  // The simulation's own copies of the points have some fields in single
  // precision.
  for (const std::string order : {"USL", "USF", "MUSL"})
    test(order, text.with("Scheme", {"Stress update = " + order}), true, 1e-5);
  test("FMPM", text.with("Scheme", {"Mass = fmpm-3"}), true, 1e-5);
  test("APIC", text.with("Scheme", {"Transfer = APIC"}), true, 1e-5);
  // Factorizations are not those of the first time.
  test("consistent", text.with("Scheme", {"Mass = consistent"}), false, 1e-5);
}

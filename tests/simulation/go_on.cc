// A program that catches the error of a step and goes on gets what it had got
// without the error: all that a step hands to the next one goes back to the
// last good state.
#include "simulation.h"

namespace
{
  constexpr unsigned int n_steps = 58;

  /**
   * Steps to n_steps; with an error in the step after @p failing.
   */
  std::vector<double>
  run(const Text &text, const unsigned int failing)
  {
    Simulated<2> simulated(text);
    while (simulated->n_steps() < failing)
      simulated->step();
    if (failing > 0)
      {
        Body<2> &body = simulated->bodies()[0];
        body.points.for_each(
          [&](const unsigned int, const auto p) { p.velocity(0) = 1e6; });
        std::string message;
        try
          {
            simulated->step();
          }
        catch (const std::exception &error)
          {
            message = message_of(error);
          }
        check("the step fails",
              message.find("has left the grid") != std::string::npos);
        check("back to a good state",
              double(simulated->n_steps()),
              double(failing) - 1.);
      }
    while (simulated->n_steps() < n_steps)
      simulated->step();
    const Statistics<2> row = simulated->statistics();
    return {simulated->time(),
            simulated->last_step(),
            simulated->critical(),
            row.kinetic,
            row.strain,
            row.center[0]};
  }

  void
  test(const std::string &what, const Text &text, const double tolerance)
  {
    const auto never = run(text, 0), once = run(text, 55);
    double     largest = 0.;
    for (unsigned int k = 0; k < never.size(); ++k)
      largest =
        std::max(largest, std::abs(never[k] - once[k]) / std::abs(never[k]));
    check(what, largest, tolerance);
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
  test("lumped", text, 1e-5);
  // Factorizations are not those of the first time, and copies of the points
  // have some fields in single precision.
  test("consistent", text.with("Scheme", {"Mass = consistent"}), 1e-5);
}

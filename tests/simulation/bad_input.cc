// Each kind of wrong input is answered by one clear message, and a run that
// breaks stops with step, time and point, and leaves its last good state.
#include <greville/simulation/run.h>

#include "simulation.h"

namespace
{
  void
  test(const std::string &what, const Text &text)
  {
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::ofstream("bad.prm") << text.content
                               << "subsection Output\n"
                                  "  set Directory = bad_results\n"
                                  "  set Print times = false\nend\n";
    MPI_Barrier(MPI_COMM_WORLD);
    // The header is that of a good run.
    std::streambuf *const buffer = std::cout.rdbuf(nullptr);
    std::string           message;
    try
      {
        ParameterAcceptor::clear();
        run_simulations("bad.prm", MPI_COMM_WORLD);
        message = "accepted";
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    // Nobody reads the file any more when it is written again.
    MPI_Barrier(MPI_COMM_WORLD);
    std::cout.rdbuf(buffer);
    std::cout.clear();
    std::cout.width(0);
    print() << "-- " << what << '\n' << message << '\n' << std::endl;
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const Text good = block_2d("box(0.25, 0.25, 0.75, 0.75)", 4)
                      .with("Time", {"End = 0.02", "Step = 0.01"})
                      .with("Material solid", {"Youngs modulus = 10"});
  if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::ofstream("good.csv") << "t,z\n0,1\n1,2\n";
  test("good", good);
  test("no body", good.with("Simulation", {"Bodies ="}));
  test("a body twice", good.with("Simulation", {"Bodies = body, body"}));
  test("unknown model", good.with("Material solid", {"Model = rubber"}));
  test("unknown material", good.with("Body body", {"Material = sand"}));
  test("negative density", good.with("Material solid", {"Density = -1"}));
  test("typo in a parameter", good.with("Time", {"Ende = 1"}));
  test("body sticks out", good.with("Body body", {"Shape = box(0, 0, 2, 1)"}));
  test("body outside of the grid",
       good.with("Body body", {"Shape = ball(5, 5, 1)"}));
  test("empty body", good.with("Body body", {"Shape = ball(0.5, 0.5, 0.001)"}));
  test("no shape", good.with("Body body", {"Shape ="}));
  test("typo in a shape", good.with("Body body", {"Shape = bal(0, 0, 1)"}));
  test("shape with too few numbers",
       good.with("Body body", {"Shape = ball(0, 0)"}));
  test("typo in a formula", good.with("Body body", {"Velocity = sin(x; 0"}));
  test("too few formulas", good.with("Loads", {"Gravity = -9.81"}));
  test("missing CSV",
       good.with("Body body", {"Shape =", "Points file = nowhere.csv"}));
  test("missing reference",
       good.with("Reference", {"Surface file = nowhere.csv"}));
  test("unknown quantity",
       good.with("Reference",
                 {"Series file = good.csv", "Series quantity = fronts"}));
  test("step above the limit", good.with("Time", {"End = 10", "Step = 1"}));
  test("negative step", good.with("Time", {"Step = -h"}));
  test("no CFL number", good.with("Time", {"Step =", "CFL number = 0"}));
  test("traction without area",
       good.with("Simulation", {"Tractions = pull"})
         .with("Traction pull",
               {"Shape = ball(0.5, 0.5, 1)", "Traction = 1; 0"}));
  test("friction of a wall without it",
       good.with("Walls", {"Top = fixed", "Top friction = 0.3"}));
  test("front wall in 2D", good.with("Walls", {"Front = fixed"}));
  test("surface without K0", good.with("Body body", {"Surface = 1"}));
  test("unknown mass", good.with("Scheme", {"Mass = lumpd"}));
  test("APIC with a reconstruction",
       good.with("Scheme", {"Transfer = APIC", "Quadrature = least-squares"}));
  test("moving wall without velocity", good.with("Walls", {"Top = moving"}));
  test("wall that moves along its normal",
       good.with("Walls", {"Top = moving", "Top velocity = 0; -1e4"}));
  test("bodies with imposed velocities only",
       good.with("Body body", {"Imposed velocity = 0; 0"}));
  test("velocity of a wall that does not move",
       good.with("Walls", {"Top velocity = 1; 0"}));
  test("grid upside down", good.with("Grid", {"Upper corner = 1, -1"}));
  test("three numbers in 2D", good.with("Grid", {"Cells = 4, 4, 4"}));
  test("sweep that does not fit",
       good.with("Grid", {"Cells = 4, 3"}).with("Sweep", {"Cells = 5"}));
  test("no place for probes", good.with("Output", {"Probes = 1"}));
  test("traction without points",
       good.with("Simulation", {"Tractions = pull"})
         .with("Traction pull",
               {"Shape = ball(9, 9, 1)", "Traction = 1; 0", "Area = 1"}));
  test("K0 without gravity",
       good.with("Body body", {"K0 = 0.5", "Surface = 1"}));
  test("stress and K0",
       good.with("Body body",
                 {"K0 = 0.5", "Surface = 1", "Stress = 1; 1; 1; 0"}));

  // Runs that break
  const Text flying =
    good.with("Body body", {"Velocity = 9; 0"})
      .with("Time", {"End = 1", "Step = 0.01", "Too large step = ignore"});
  test("point leaves the grid", flying);
  {
    const bool first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    check("the last good state is there",
          !first || std::filesystem::exists("bad_results/points_0001.pvtu"));
  }
  test("points may leave the grid",
       flying.with("Scheme", {"Points outside = remove"}));
  test("negative volume",
       good.with("Body body", {"Velocity = -30 * (x - 0.5); -30 * (y - 0.5)"})
         .with("Time", {"End = 1", "Step = 0.05", "Too large step = ignore"}));
}

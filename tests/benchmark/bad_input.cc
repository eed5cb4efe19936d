// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks that each kind of wrong input yields one clear message.

#include <greville/benchmark/benchmark.h>

#include <fstream>
#include <tests.h>

namespace
{
  void
  test(const std::string &content)
  {
    const std::string file = "bad.prm";
    {
      std::ofstream out(file);
      out << content << "\nsubsection Benchmark\n"
          << "  set Output directory = bad_results\n"
          << "  set Print times = false\nend\n";
    }
    try
      {
        Benchmark benchmark("greville_benchmark");
        benchmark.run(file);
        print() << "accepted: " << content << std::endl;
      }
    catch (const std::exception &error)
      {
        // The free memory differs between machines.
        std::string message = message_of(error);
        const auto  free    = message.find(" of memory, and ");
        if (free != std::string::npos)
          message = message.substr(0, free) + " of memory";
        print() << "-- " << content << '\n' << message << '\n' << std::endl;
      }
  }

  void
  in(const std::string &section, const std::string &line)
  {
    test("subsection " + section + "\n  set " + line + "\nend");
  }
} // namespace



void
test_main()
{
  in("Benchmark", "Orders = 0");
  in("Benchmark", "Orders = 1, 6");
  in("Benchmark", "Orders = two");
  in("Benchmark", "Cells = 0");
  in("Benchmark", "Cells = 8, -4");
  in("Benchmark", "Cells = 8; 4; 2");
  in("Benchmark", "Dimensions = 1");
  in("Benchmark", "Solvers = p-multgrid");
  in("Benchmark", "Solvers = fmpm-0");
  in("Benchmark", "Solvers =");
  in("Benchmark", "Smoothers = ilut, ilu");
  in("Benchmark", "Cycles = X");
  in("Benchmark", "Restrictions = injection");
  in("Benchmark", "Prolongations = injection");
  in("Benchmark", "Coarsenings = by three");
  in("Benchmark", "Repetitions = 0");
  in("Benchmark", "Published iterations = cg");
  in("Benchmark", "Published iterations = cg:no_such_file.csv");
  in("Benchmark", "Published iterations = cg:.");
  in("Benchmark", "Published iterations = cg:bad.prm");
  in("Benchmark", "Published iterations = cg:/dev/null");
  in("Benchmark", "Oders = 2");
  in("Benchmark", "Solvers = cg, cg");
  in("Benchmark", "Cells = 100000");
  in("Problem", "Cell ratio = 100000, 100000");
  in("Smoother", "PETSc options = pc_type");
  in("Problem", "Density = x - 0.5");
  in("Problem", "Density = 1 + ");
  in("Problem", "Density = 1 + w");
  in("Problem", "Density = 0");
  in("Problem", "Density = x = 3");
  in("Problem", "Density = 0,5");
  in("Problem", "Acceleration = sqrt(0.5 - x)");
  in("Problem", "Acceleration = 1e300");
  in("Problem", "Points = ball");
  in("Problem", "Points = cone");
  test("subsection Problem\n  set Points = box\n  set Density = 0\nend");
  test("subsection Problem\n  set Points = box\n  set Density = x - 0.5\nend");
  in("Problem", "Upper corner = 1, 0, 1");
  in("Problem", "Upper corner = 1");
  in("Solver", "Tolerance = -1");
  in("Solver", "Operator = sparse");
  in("p-multigrid", "Smoother = ilutp");
  in("p-multigrid", "Pre-smoothing steps = -1");
  in("Smoother", "Ordering = random");
  in("Benchmark", "Operators = stiffness");
  in("Benchmark", "Operators = mass, mass");
  const std::string elastic =
    "subsection Benchmark\n  set Operators = mass and elasticity\n"
    "  set Solvers = cg-p-multigrid\n";
  test(elastic + "  set Poisson ratios = 0.3, 0.5\nend");
  test(elastic + "  set Courant numbers = 0\nend");
  test(elastic + "  set Courant numbers = 10, -1\nend");
  test(elastic + "  set Solvers = tensor-product\nend");
  test("subsection Benchmark\n  set Operators = laplace\nend\n"
       "subsection Problem\n  set Points = disk\nend");
  in("Problem", "Clamped walls = Front");
  in("Problem", "Clamped walls = Floor");
  in("Problem", "Shapes = box(0, 0, 1, 1)");
  in("Problem", "Shapes = dome: bell(0.5, 0, 0.4)");
  test("subsection No such section\nend");
  test("nonsense");

  try
    {
      Benchmark().run("no_such_file.prm");
    }
  catch (const std::exception &error)
    {
      print() << message_of(error) << std::endl;
    }
}

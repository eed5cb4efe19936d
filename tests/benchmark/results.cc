// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2
// Debug: no

// Checks the output of a run: columns and rows of its CSV files, the
// parameters, no temporary file. Each option of the benchmark must affect them.

#include <greville/benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <tests.h>

namespace
{
  using Rows = std::vector<std::vector<std::string>>;

  Rows
  read_csv(const std::string &file)
  {
    Rows          rows;
    std::ifstream in(file);
    std::string   line;
    while (std::getline(in, line))
      {
        line += ",";
        rows.emplace_back();
        std::istringstream words(line);
        std::string        word;
        while (std::getline(words, word, ','))
          rows.back().push_back(word);
      }
    return rows;
  }

  // True if the last run ended with an error because no solve had converged.
  bool all_failed = false;

  // Run with some lines more than the base, and give solves.csv.
  Rows
  run(const std::string &more, const std::string &folder = "run")
  {
    const std::string file = folder + ".prm";
    // All have to be done with the last run's files.
    MPI_Barrier(MPI_COMM_WORLD);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      {
        std::filesystem::remove_all(folder);
        std::ofstream out(file);
        out << "subsection Benchmark\n"
            << "  set Orders = 2\n  set Cells = 8\n"
            << "  set Output directory = " << folder << "\nend\n"
            << more;
      }
    MPI_Barrier(MPI_COMM_WORLD);
    // The tables go to the console; this test is about files.
    std::ostringstream console;
    std::streambuf    *buffer = std::cout.rdbuf(console.rdbuf());
    Benchmark          benchmark;
    all_failed = false;
    try
      {
        benchmark.run(file);
      }
    catch (const std::exception &error)
      {
        all_failed =
          message_of(error).find("All solves have failed") != std::string::npos;
        if (!all_failed)
          throw;
      }
    std::cout.rdbuf(buffer);
    MPI_Barrier(MPI_COMM_WORLD);
    const Rows rows = read_csv(folder + "/solves.csv");
    MPI_Barrier(MPI_COMM_WORLD);
    return rows;
  }

  std::string
  in(const std::string &section, const std::string &line)
  {
    return "subsection " + section + "\n  set " + line + "\nend\n";
  }

  std::string
  column(const Rows &rows, const std::string &name, const unsigned int row = 1)
  {
    for (unsigned int k = 0; k < rows[0].size(); ++k)
      if (rows[0][k] == name)
        return rows[row][k];
    return "no such column";
  }
} // namespace



void
test_main()
{
  Rows rows = run(in("Benchmark",
                     "Solvers = p-multigrid, fgmres-p-multigrid, "
                     "cg-p-multigrid, cg, cg-jacobi, cg-tensor-product, "
                     "tensor-product, lumped, fmpm-3") +
                  in("Benchmark", "Operator throughput = true"));
  for (const std::string &name : rows[0])
    print() << name << ' ';
  print() << std::endl;
  for (unsigned int row = 1; row < rows.size(); ++row)
    print() << column(rows, "solver", row) << ": smoother <"
            << column(rows, "smoother", row) << ">, cycle <"
            << column(rows, "cycle", row) << ">, restriction <"
            << column(rows, "restriction", row) << ">, unknowns "
            << column(rows, "unknowns", row) << ", iterations "
            << (column(rows, "iterations", row).empty() ? "empty" : "given")
            << ", converged " << column(rows, "converged", row) << std::endl;
  check("times are positive",
        std::stod(column(rows, "assembly_s")) > 0 &&
          std::stod(column(rows, "solve_s")) > 0);
  check("memory",
        column(rows, "peak_bytes").empty() ||
          std::stod(column(rows, "peak_bytes")) > 1e6);
  const Rows operators = read_csv("run/operators.csv");
  check("operators.csv",
        operators.size() == 2 &&
          std::stod(column(operators, "matrix_free_dofs_per_s")) > 0 &&
          std::stod(column(operators, "assembled_dofs_per_s")) > 0 &&
          std::stod(column(operators, "tensor_product_dofs_per_s")) > 0 &&
          std::stod(column(operators, "bandwidth_bytes_per_s")) > 0);
  unsigned int n_files = 0;
  for (const auto &entry : std::filesystem::directory_iterator("run"))
    {
      check("no temporary file", entry.path().extension() != ".tmp");
      ++n_files;
    }
  check("three files", n_files == 3);

  // Effects.
  rows = run("");
  check("base", rows.size() == 2 && column(rows, "unknowns") == "100");
  check("Dimensions",
        column(run(in("Benchmark", "Dimensions = 3")), "unknowns") == "1000");
  check("Orders",
        column(run(in("Benchmark", "Orders = 3")), "unknowns") == "121");
  check("Cells", column(run(in("Benchmark", "Cells = 9")), "cells") == "9");
  check("Cell ratio",
        column(run(in("Problem", "Cell ratio = 1, 2")), "unknowns") == "180");
  check("Smoothers",
        column(run(in("Benchmark", "Smoothers = ic0, jacobi")),
               "smoother",
               2) == "jacobi");
  check("Cycles",
        column(run(in("Benchmark", "Cycles = V, W, F")), "cycle", 3) == "F");
  check("Restrictions",
        column(run(in("Benchmark", "Restrictions = transpose")),
               "restriction") == "transpose");
  check("Prolongations",
        column(run(in("Benchmark", "Prolongations = lumped-l2, exact-l2")),
               "prolongation",
               2) == "exact-l2");
  rows = run(in("Benchmark", "Coarsenings = none, direct") +
             in("Benchmark", "Solvers = cg, p-multigrid"));
  check("Coarsenings",
        rows.size() == 4 && column(rows, "coarsening", 2) == "none" &&
          column(rows, "coarsening", 3) == "direct");
  check("smoother, cycle and restriction of p-multigrid",
        column(run(in("p-multigrid", "Smoother = ic0") +
                   in("p-multigrid", "Cycle = W") +
                   in("p-multigrid", "Restriction = exact-l2")),
               "cycle") == "W");
  const auto error = [](const std::string &more) {
    return std::stod(column(run(more), "error"));
  };
  const std::string f    = in("Problem", "Acceleration = sin(3*x)*exp(y)");
  const double      base = error(f);
  check("Acceleration", base > 1e-5 && error("") < 1e-7);
  check("Density",
        std::abs(error(f + in("Problem", "Density = 1+9*x")) - base) >
          1e-3 * base);
  check("Upper corner",
        error(f + in("Problem", "Upper corner = 2, 2")) > 2 * base);
  check("Lower corner",
        error(f + in("Problem", "Lower corner = -1, 0")) > 1.5 * base);

  // Material points. A polynomial of the splines' order is found again.
  const std::string points = in("Benchmark", "Solvers = cg-jacobi") +
                             in("Solver", "Tolerance = 1e-12") + f +
                             in("Problem", "Points = disk");
  rows = run(points);
  check("Points",
        column(rows, "body") == "disk" && column(rows, "stable") != "" &&
          std::stoi(column(rows, "extended")) > 0 &&
          column(run(points + in("Problem", "Points = box")), "extended") !=
            column(rows, "extended"));
  check("Points, acceleration",
        std::stod(column(rows, "error")) > 1e-6 &&
          error(points + in("Problem", "Acceleration = x*y-y*y")) < 1e-9);
  check("Points, density",
        std::abs(error(points + in("Problem", "Density = 1+9*x")) -
                 error(points)) > 1e-4 * error(points));
  rows = run(points + in("Problem", "Points per direction = 2, 4"));
  check("Points per direction",
        rows.size() == 3 && column(rows, "points_per_direction", 2) == "4" &&
          column(rows, "error", 1) != column(rows, "error", 2));
  check("Jitter", error(points) != error(points + in("Problem", "Jitter = 0")));
  check("Filling threshold",
        column(run(points + in("Problem", "Filling threshold = 0.2")),
               "extended") != column(run(points), "extended"));
  check("Extension",
        column(run(points + in("Problem", "Extension = false")), "extended")
          .empty());

  rows =
    run(in("Problem", "Points = box, column, disk") +
        in("Benchmark", "Solvers = cg-p-multigrid") +
        in("Benchmark", "Coarsenings = one by one, by two, none") +
        in("Benchmark", "Smoothers = ic0") + in("Benchmark", "Orders = 1, 2") +
        in("p-multigrid", "Restriction = transpose"));
  bool all_converge = rows.size() == 19;
  for (unsigned int row = 1; row < rows.size(); ++row)
    all_converge = all_converge && column(rows, "converged", row) == "1" &&
                   std::stoi(column(rows, "iterations", row)) <= 30;
  check("Points, p-multigrid", all_converge);

  // Pivots of IC(0) are positive here, but its factors are nearly singular:
  // 14 iterations without a shift.
  rows =
    run(in("Benchmark", "Dimensions = 3") + in("Benchmark", "Orders = 3") +
        in("Benchmark", "Cells = 12") +
        in("Benchmark", "Solvers = cg-p-multigrid") +
        in("Benchmark", "Smoothers = ic0") + in("Problem", "Points = ball") +
        in("p-multigrid", "Coarsening = none") +
        in("p-multigrid", "Restriction = transpose") +
        in("Smoother", "Overlap = 2"));
  check("Points, IC(0) that is nearly singular",
        std::stoi(column(rows, "iterations")),
        9);

  // Without their scale, two steps of symmetric Schwarz are indefinite on two
  // processes: 54 iterations.
  rows = run(in("Benchmark", "Orders = 4") + in("Benchmark", "Cells = 32") +
             in("Benchmark", "Solvers = cg-p-multigrid") +
             in("Benchmark", "Smoothers = ic0") +
             in("Benchmark", "Coarsenings = one by one") +
             in("Problem", "Points = disk") +
             in("Problem", "Points per direction = 2") +
             in("Problem", "Jitter = 0.5") +
             in("p-multigrid", "Restriction = transpose") +
             in("Smoother", "Overlap = 2"));
  check("Points, Schwarz on several processes",
        std::stoi(column(rows, "iterations")),
        20);

  check("Output directory",
        run("", "elsewhere").size() == 2 &&
          std::filesystem::exists("elsewhere/parameters.prm"));

  // An odd number of repetitions gives one row as well; the time of the solve
  // is a median of that many.
  check("Repetitions", run(in("Benchmark", "Repetitions = 3")).size() == 2);

  // If one variant cannot be set up, the others still run.
  rows = run(in("Benchmark", "Smoothers = petsc, ic0") +
             in("Smoother", "PETSc options = -pc_type no_such"));
  check("failed solve",
        rows.size() == 3 && column(rows, "converged") == "0" &&
          column(rows, "converged", 2) == "1");

  // Coarsening and coarse tolerance change the iterations of a weak smoother.
  const std::string weak =
    in("Benchmark", "Smoothers = jacobi") + in("Benchmark", "Orders = 4") +
    in("Benchmark", "Cells = 16") + in("Solver", "Tolerance = 1e-10");
  const auto reduction = [&](const std::string &more) {
    return column(run(weak + more), "reduction");
  };
  const std::string before = reduction("");
  check("a run in which all solves fail ends with an error", all_failed);
  check("Coarsening",
        reduction(in("p-multigrid", "Coarsening = direct")) != before &&
          reduction(in("p-multigrid", "Coarsening = by two")) != before);
  check("Coarse tolerance",
        reduction(in("p-multigrid", "Coarse tolerance = 0.5")) != before);
  check("Prolongation",
        reduction(in("p-multigrid", "Prolongation = exact-l2")) != before);
}

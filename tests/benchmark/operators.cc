// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// All: 2
// Debug: no

// Checks all operators on boxes and on bodies of points: the iterations depend
// little on the number of processes, and the columns have the expected values.

#include <greville/benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <tests.h>

namespace
{
  using Rows = std::vector<std::map<std::string, std::string>>;

  std::vector<std::string>
  split(const std::string &line)
  {
    std::vector<std::string> words(1);
    for (const char c : line)
      if (c == ',')
        words.emplace_back();
      else
        words.back() += c;
    return words;
  }

  Rows
  run(const std::string &lines, const std::string &problem = "")
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::ofstream("run.prm")
        << "subsection Benchmark\n  set Output directory = run\n"
        << lines << "end\nsubsection Problem\n  set Jitter = 0.3\n"
        << problem << "end\n"
        << "subsection Solver\n  set Maximum iterations = 400\nend\n";
    MPI_Barrier(MPI_COMM_WORLD);
    std::ostringstream console;
    std::streambuf    *buffer = std::cout.rdbuf(console.rdbuf());
    Benchmark().run("run.prm");
    std::cout.rdbuf(buffer);
    MPI_Barrier(MPI_COMM_WORLD);
    std::ifstream file("run/solves.csv");
    std::string   line;
    std::getline(file, line);
    const auto names = split(line);
    Rows       rows;
    while (std::getline(file, line))
      {
        const auto words = split(line);
        rows.emplace_back();
        for (unsigned int k = 0; k < names.size(); ++k)
          rows.back()[names[k]] = words.at(k);
      }
    MPI_Barrier(MPI_COMM_WORLD);
    return rows;
  }

  void
  check_iterations(const std::string                                &what,
                   const Rows                                       &rows,
                   const std::map<std::string, std::pair<int, int>> &ranges)
  {
    for (const auto &row : rows)
      {
        const auto &range = ranges.at(row.at("solver"));
        check_range(what + ", " + row.at("solver") + ", p = " + row.at("p") +
                      ", nu = " + row.at("poisson") +
                      ", C = " + row.at("courant"),
                    row.at("converged") == "1" ? std::stoi(row.at("iterations"))
                                               : 1000,
                    range.first,
                    range.second);
      }
  }
} // namespace



void
test_main()
{
  Rows rows = run("  set Operators = laplace\n  set Orders = 1, 2, 3\n"
                  "  set Cells = 24\n"
                  "  set Solvers = p-multigrid, cg-p-multigrid, "
                  "fgmres-tielen, cg, cg-smoother, cg-jacobi, cg-ic0, cg-gamg, "
                  "cg-boomeramg\n  set Restrictions = transpose\n");
  check_range("rows of laplace", rows.size(), 27, 27);
  check_iterations("laplace",
                   rows,
                   {{"p-multigrid", {1, 6}},
                    {"cg-p-multigrid", {1, 6}},
                    {"fgmres-tielen", {1, 8}},
                    {"cg", {30, 200}},
                    {"cg-smoother", {4, 60}},
                    {"cg-jacobi", {30, 80}},
                    {"cg-ic0", {8, 50}},
                    {"cg-gamg", {4, 20}},
                    {"cg-boomeramg", {3, 14}}});
  for (const auto &row : rows)
    {
      check("laplace, the solution is found", std::stod(row.at("error")), 1e-5);
      check("laplace, columns",
            row.at("operator") == "laplace" && row.at("poisson").empty() &&
              row.at("courant").empty() && row.at("body").empty());
    }
  rows = run("  set Operators = laplace\n  set Dimensions = 3\n"
             "  set Orders = 2\n  set Cells = 8\n",
             "  set Clamped walls = Left, Top\n");
  check_iterations("laplace in 3D", rows, {{"p-multigrid", {2, 8}}});

  const std::string solvers = "  set Solvers = cg-p-multigrid, cg-smoother, "
                              "cg-ic0, cg-jacobi, cg-gamg, cg-boomeramg, "
                              "fgmres-tielen\n";
  const std::map<std::string, std::pair<int, int>> ranges = {
    {"cg-p-multigrid", {4, 12}},
    {"cg-smoother", {6, 30}},
    {"cg-ic0", {3, 80}},
    {"cg-jacobi", {40, 400}},
    {"cg-gamg", {5, 80}},
    {"cg-boomeramg", {4, 30}},
    {"fgmres-tielen", {2, 16}}};
  rows = run("  set Operators = elasticity, mass and elasticity\n"
             "  set Orders = 2, 3\n  set Cells = 24\n"
             "  set Courant numbers = 3, 30\n" +
               solvers,
             "  set Points = column, col\n  set Points per direction = 3\n"
             "  set Shapes = col: ball(0.5, 0, 0.43)\n");
  check_range("rows of elasticity", rows.size(), 84, 84);
  check_iterations("elasticity", rows, ranges);
  for (const auto &row : rows)
    check("elasticity, columns",
          row.at("courant").empty() == (row.at("operator") == "elasticity") &&
            row.at("poisson") == "0.3" &&
            std::stod(row.at("unknowns_per_s")) > 0. &&
            row.at("error").empty() && std::stoi(row.at("extended")) > 0);

  // Levels, where extended functions couple functions of a coarse lattice
  // beyond stencils.
  rows = run("  set Operators = elasticity\n  set Dimensions = 3\n"
             "  set Orders = 2\n  set Cells = 13\n"
             "  set Solvers = cg-p-multigrid\n  set Poisson ratios = 0.49\n"
             "  set Coarsenings = lattice, hp, direct\n",
             "  set Points = column\n  set Points per direction = 3\n");
  check_range("rows of levels", rows.size(), 3, 3);
  check_iterations("levels", rows, {{"cg-p-multigrid", {4, 12}}});

  // The box by Gauss quadrature: B-splines are not extended. Poisson's ratio
  // and the Courant number change the operator.
  rows = run("  set Operators = mass and elasticity\n  set Orders = 2\n"
             "  set Cells = 16\n  set Solvers = cg-p-multigrid\n"
             "  set Poisson ratios = 0, 0.38\n"
             "  set Courant numbers = 1, 100\n");
  check_range("rows of the box", rows.size(), 4, 4);
  for (const auto &row : rows)
    check("box, unknowns",
          row.at("unknowns") == "648" && row.at("extended").empty());
  check_iterations("box", rows, {{"cg-p-multigrid", {3, 20}}});
  check("Poisson ratios",
        std::stoi(rows[3].at("iterations")) >
          std::stoi(rows[1].at("iterations")));

  rows = run("  set Operators = mass, elasticity\n  set Dimensions = 3\n"
             "  set Orders = 2\n  set Cells = 8\n"
             "  set Solvers = cg-p-multigrid\n  set Smoothers = ic0\n",
             "  set Points = column\n");
  check("operators of a run",
        rows.size() == 2 && rows[0].at("operator") == "mass" &&
          rows[0].at("body") == "column" && !rows[0].at("error").empty() &&
          rows[1].at("operator") == "elasticity");
}

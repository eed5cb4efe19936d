// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks the files that a run writes.
#include <greville/run/run.h>

#include "simulation.h"
#include <boost/property_tree/json_parser.hpp>

namespace
{
  std::vector<std::string>
  lines_of(const std::string &file)
  {
    std::ifstream            in(file);
    std::vector<std::string> result;
    for (std::string line; std::getline(in, line);)
      result.push_back(line);
    return result;
  }

  void
  run_quietly(const std::string &file, const RunOptions &options = RunOptions())
  {
    std::streambuf *const buffer  = std::cout.rdbuf(nullptr);
    const auto            restore = [&]() {
      std::cout.rdbuf(buffer);
      std::cout.clear();
      std::cout.width(0);
    };
    try
      {
        run_simulations(file, MPI_COMM_WORLD, options);
      }
    catch (const std::exception &)
      {
        restore();
        throw;
      }
    restore();
    MPI_Barrier(MPI_COMM_WORLD);
  }

  void
  run(const Text &text, const std::string &directory)
  {
    const bool first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    // Others may still read what is removed here.
    MPI_Barrier(MPI_COMM_WORLD);
    if (first)
      {
        std::filesystem::remove_all(directory);
        std::ofstream("run.prm")
          << text.with("Output", {"Directory = " + directory}).content;
      }
    MPI_Barrier(MPI_COMM_WORLD);
    run_quietly("run.prm");
  }



  /// Iterations of Newton's method, of a run and of one that goes on with it
  /// after a step that the checkpoint does not have; units of all columns.
  void
  check_newton(const Text &text)
  {
    run(text.with("Scheme", {"Mass = consistent", "Stress update = newmark"})
          .with("Time", {"End = 0.02", "Step = 0.01"})
          .with("Output",
                {"Probes = 0.3, 0.3",
                 "Fields = velocity, displacement, stress, pressure, "
                 "von_mises, J, density, body, id, reference, F, strain, mass, "
                 "volume, size, process, history"}),
        "newton");
    const auto rows = lines_of("newton/newton.csv");
    print() << rows[0] << std::endl;
    check("rows of newton.csv", rows.size() >= 5);
    check("its first step", rows[1].rfind("1,1,0,0.01,0,", 0) == 0);
    check("its last step has converged",
          rows.back().rfind("2,1,0.01,0.01,", 0) == 0 &&
            rows.back().back() == '1');
    const auto units = lines_of("newton/files/units.csv");
    check("each column has a unit",
          std::none_of(units.begin(), units.end(), [](const std::string &line) {
            return line.back() == ',';
          }));
    check("units of fields",
          std::count(units.begin(), units.end(), "points,F_xy,1") == 1 &&
            std::count(units.begin(), units.end(), "points,size,m") == 1 &&
            std::count(units.begin(),
                       units.end(),
                       "statistics.csv,momentum_y,kg / s") == 1);

    // All have read the files.
    MPI_Barrier(MPI_COMM_WORLD);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      {
        std::ofstream("newton/newton.csv", std::ios::app)
          << "3,1,0.02,0.01,0,1,1,0,0,0\n";
        const auto    lines = lines_of("newton/parameters.prm");
        std::ofstream changed("newton/parameters.prm");
        for (const std::string &line : lines)
          changed << line << '\n';
        changed << "subsection Time\n  set End = 0.03\nend\n";
        std::filesystem::remove("newton/statistics.csv");
      }
    MPI_Barrier(MPI_COMM_WORLD);
    RunOptions options;
    options.resumes = true;
    run_quietly("newton/parameters.prm", options);
    const auto more = lines_of("newton/newton.csv");
    check("a note",
          lines_of("newton/messages.log").back() ==
            "Note: The run continues after step 2.");
    const auto messages   = lines_of("newton/messages.log");
    const auto statistics = lines_of("newton/statistics.csv");
    check("a file that is gone begins anew",
          messages[messages.size() - 2].find(
            "newton/statistics.csv>, which the run has written before.") !=
              std::string::npos &&
            statistics[0].rfind("time,dt,", 0) == 0 &&
            statistics[1].rfind("0.03,", 0) == 0);
    check("newton.csv goes on",
          more.size() > rows.size() &&
            std::equal(rows.begin(), rows.end(), more.begin()) &&
            more.back().rfind("3,1,0.02,0.01,", 0) == 0 &&
            more.back().back() == '1');
  }



  /// messages.log: a warning, and the error that ends a run.
  void
  check_messages(const Text &text)
  {
    run(text.with("Time", {"End = 0.2", "Step = 0.1", "Too large step = warn"}),
        "warned");
    const auto warnings = lines_of("warned/messages.log");
    check("warnings",
          warnings.size() >= 1 &&
            warnings[0].rfind("Warning: The parameter 'Time/Step' is <0.1>",
                              0) == 0);
    bool has_failed = false;
    try
      {
        run(text.with("Time", {"End = 1", "Step = 0.1"}), "failed");
      }
    catch (const std::exception &)
      {
        has_failed = true;
      }
    MPI_Barrier(MPI_COMM_WORLD);
    const auto errors = lines_of("failed/messages.log");
    check("an error",
          has_failed && errors.size() == 1 &&
            errors[0].rfind("Error: ", 0) == 0);
  }
} // namespace



void
test_main()
{
  const Text text =
    block_2d("box(0.25, 0.25, 0.75, 0.75)", 4)
      .with("Loads", {"Gravity = 0; -1"})
      .with("Time", {"End = 0.1", "Step = 0.005"})
      .with("Exact solution",
            {"Displacement = 0; -0.5 * t^2", "Velocity = 0; -t"});

  run(text.with("Output",
                {"Fields every = 0.05",
                 "Statistics every = 0.02",
                 "Probes = 0.3, 0.3; 0.7, 0.7"}),
      "results");
  for (const std::string file : {"parameters.prm",
                                 "statistics.csv",
                                 "probes.csv",
                                 "summary.json",
                                 "fields.pvd",
                                 "files/points_0002.vtu",
                                 "files/grid_0002.vtu"})
    check(file, std::filesystem::exists("results/" + file));
  check("no more fields than asked for",
        !std::filesystem::exists("results/files/points_0003.vtu"));
  const auto statistics = lines_of("results/statistics.csv");
  print() << statistics[0] << std::endl;
  check("lines of statistics", statistics.size() == 7);
  const auto probes = lines_of("results/probes.csv");
  print() << probes[0] << std::endl;
  check("lines of probes", probes.size() == 7);
  {
    unsigned int n = 0;
    for (const std::string &line : lines_of("results/fields.pvd"))
      n += line.find("name=\"points\" file=\"files/points_000") !=
           std::string::npos;
    check("fields.pvd names three times", n == 3);
  }
  {
    // The first file of the grid has the cells of the body, too.
    unsigned int n = 0;
    for (const std::string &line : lines_of("results/files/grid_0000.vtu"))
      n += line.find("NumberOfCells=") != std::string::npos &&
           line.find("NumberOfCells=\"0\"") == std::string::npos;
    check("first fields of the grid have cells", n > 0);
  }
  {
    boost::property_tree::ptree json;
    boost::property_tree::read_json("results/summary.json", json);
    check("steps", json.get<int>("steps") == 20);
    check("points", json.get<int>("points") == 16);
    check("cells", json.get<int>("cells") == 16);
    check("p", json.get<int>("p") == 2);
    check("processes",
          json.get<unsigned int>("processes") ==
            Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));
    check("wall time", json.get<double>("wall_time") > 0.);
    check("rate", json.get<double>("point_steps_per_second") > 0.);
    check("parts", json.get_child("parts").size() >= 5);
    check("displacement error",
          json.get<double>("errors.displacement.l2"),
          1e-10);
    check("velocity error", json.get<double>("errors.velocity.max"), 1e-10);
  }

  // The copy of the parameters runs and gives the same.
  if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::filesystem::copy_file(
      "results/parameters.prm",
      "copy.prm",
      std::filesystem::copy_options::overwrite_existing);
  MPI_Barrier(MPI_COMM_WORLD);
  run_quietly("copy.prm");
  check("a copy gives the same statistics",
        lines_of("results/statistics.csv") == statistics);

  check_newton(text);
  check_messages(text);

  // Without grid fields; each step in the statistics.
  run(text.with("Output", {"Grid fields = false"}), "no_grid");
  check("no grid fields",
        !std::filesystem::exists("no_grid/files/grid_0000.vtu"));
  check("each step", lines_of("no_grid/statistics.csv").size() == 22);
}

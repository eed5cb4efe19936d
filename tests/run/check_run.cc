// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks --check, which estimates the cost of a run without results, and
// command-line settings in runs.
#include <greville/run/run.h>

#include "simulation.h"
#include <regex>

namespace
{
  bool
  is_first()
  {
    return Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  }



  /// Return the output of @p action, or its message.
  std::string
  output_of(const std::function<void()> &action)
  {
    std::ostringstream    text;
    std::streambuf *const buffer = std::cout.rdbuf(text.rdbuf());
    try
      {
        action();
      }
    catch (const std::exception &error)
      {
        text << message_of(error);
      }
    std::cout.rdbuf(buffer);
    std::cout.clear();
    MPI_Barrier(MPI_COMM_WORLD);
    return text.str();
  }



  std::string
  check_of(const Text        &text,
           const RunOptions  &options = RunOptions(),
           const std::string &drawing = "")
  {
    if (is_first())
      std::ofstream("run.prm") << text.content;
    MPI_Barrier(MPI_COMM_WORLD);
    return output_of([&]() {
      check_simulations("run.prm", MPI_COMM_WORLD, options, drawing);
    });
  }



  /// The first process has what is printed.
  void
  has(const std::string              &name,
      const std::string              &text,
      const std::vector<std::string> &wanted)
  {
    for (const std::string &word : wanted)
      {
        check(name + ": " + word,
              !is_first() || text.find(word) != std::string::npos);
        if (is_first() && text.find(word) == std::string::npos)
          std::cout << "<" << text << ">" << std::endl;
      }
  }
} // namespace



void
test_main()
{
  if (is_first())
    for (const std::string folder : {"check_results", "drawing"})
      std::filesystem::remove_all(folder);
  MPI_Barrier(MPI_COMM_WORLD);
  const Text good = block_2d("box(0.25, 0.25, 0.75, 0.75)", 8)
                      .with("Time", {"End = 1", "Step = 0.001"})
                      .with("Output", {"Directory = check_results"});

  has("explicit steps",
      check_of(good),
      {"grid: 8 x 8 cells, order 2",
       "cells: 64, B-splines: 100 for each component, points: 64",
       "critical step: 0.00",
       "step: 0.001 s, the mean of 20 trial step(s) from t = 0 s",
       "number of steps: about 1000 to t = 1 s",
       "estimated time: ",
       "memory: at most ",
       "results of a run: check_results"});
  // The results of shapes, units and the loaded part of the surface.
  const Text loaded = good.with("Material solid", {"Density = 2"})
                        .with("Body body", {"Placement = fitted"})
                        .with("Simulation", {"Surface loads = weight"})
                        .with("Surface load weight",
                              {"Body = body",
                               "Kind = pressure",
                               "Pressure = 3 * t",
                               "Where = y > 0.74"});
  has("sums",
      check_of(loaded),
      {"  body               mass, kg/m     area, m^2\n"
       "  body                      0.5          0.25\n",
       "  surface load        length, m   force, N/m\n"
       "  weight                    0.5   (0, 0) at t = 0 s, (0, -1.5) at t = "
       "1 s\n"});
  RunOptions settings;
  settings.settings = {"Time/Step=0.002", "Grid/Order=3"};
  has("settings",
      check_of(good, settings),
      {"order 3", "step: 0.002 s", "about 500 to"});
  has("a limit of steps",
      check_of(good.with("Time", {"Maximum steps = 5"})),
      {"mean of 5 trial step(s)",
       "number of steps: 5, as 'Time/Maximum steps' says"});
  has("implicit steps",
      check_of(good.with("Scheme", {"Stress update = newmark"})
                 .with("Time", {"Step = 0.1", "End = 0.5"})),
      {"level  order       unknowns   used",
       "number of steps: about 5 to t = 0.5 s",
       " s, or more if later steps need more iterations: "});
  has("stages",
      check_of(
        good.with("Simulation", {"Stages = one, two"})
          .add("Stage one\n  subsection Time\n    set End = 0.5\n  end", {})
          .add("Stage two\n  subsection Time\n    set End = 1\n  end", {})),
      {"Stage 1 (one): t = 0 to 0.5 s",
       "number of steps: about 500 to t = 0.5 s",
       "  Stage 2 (two):\n",
       "trial step(s) from t = 0.5 s",
       "number of steps: about 500 to t = 1 s",
       "estimated time of all stages: "});
  has("bodies with grids of their own",
      check_of(good.with("Grid", {"Per body = true"})
                 .with("Scheme", {"Formulation = total Lagrangian"})),
      {"grid of body:", "critical step: "});
  has("too large steps",
      check_of(good.with("Time", {"Step = 0.1"})),
      {"above the critical step"});
  has("a formula that fails at the end",
      check_of(good.with("Exact solution", {"Displacement = 1/(1 - t); 0"})),
      {"'Exact solution/Displacement'"});
  has("a missing file",
      check_of(good.with("Reference", {"Surface file = no_such.csv"})),
      {"no_such.csv"});
  check("no results", !std::filesystem::exists("check_results"));

  has("a drawing", check_of(good, {}, "drawing"), {"drawing/fields.pvd"});
  check("the drawing is there",
        std::filesystem::exists("drawing/fields.pvd") &&
          std::filesystem::exists("drawing/parameters.prm"));
  has("a folder that is in use",
      check_of(good, {}, "drawing"),
      {"The folder <drawing> of --draw is not empty"});

  // Runs with settings, and checks of what goes on with them.
  if (is_first())
    std::ofstream("run.prm") << good.content;
  MPI_Barrier(MPI_COMM_WORLD);
  RunOptions short_run;
  short_run.settings = {"Time/Maximum steps=4", "Grid/Order=1"};
  const auto run     = [&](const RunOptions &options) {
    return output_of(
      [&]() { run_simulations("run.prm", MPI_COMM_WORLD, options); });
  };
  has("a run", run(short_run), {"4 steps"});
  {
    std::ostringstream used;
    used << std::ifstream("check_results/parameters.prm").rdbuf();
    check("parameters.prm has the settings",
          std::regex_search(used.str(), std::regex("set Maximum steps += 4")) &&
            std::regex_search(used.str(), std::regex("set Order += 1")));
  }
  const auto files_before =
    std::distance(std::filesystem::directory_iterator("check_results"),
                  std::filesystem::directory_iterator());
  short_run.resumes = true;
  has("a run at its end", check_of(good, short_run), {"no step to take"});
  short_run.settings[0] = "Time/Maximum steps=8";
  has("a run that goes on",
      check_of(good, short_run),
      {"It would resume from <check_results/checkpoint_0000000004.h5>, step 4",
       "number of steps: 4, as"});
  RunOptions other = short_run;
  other.settings.push_back("Grid/Cells=4, 4");
  has("a run that cannot go on",
      check_of(good, other),
      {"these parameters have changed", "'Grid/Cells'"});
  RunOptions from;
  from.from     = "check_results";
  from.settings = {"Output/Directory=elsewhere", "Grid/Cells=4, 4"};
  has("another run",
      check_of(good, from),
      {"It would begin with <check_results/checkpoint_0000000004.h5>",
       "grid: 4 x 4 cells"});
  check("nothing has been written or moved",
        !std::filesystem::exists("elsewhere") &&
          files_before ==
            std::distance(std::filesystem::directory_iterator("check_results"),
                          std::filesystem::directory_iterator()));
  // A checkpoint of a version in which E and nu had other names.
  has("names of earlier versions",
      describe_changes("subsection Material solid\n"
                       "  set Young modulus = 100\nend\n",
                       "subsection Material solid\n"
                       "  set Young modulus = 200\nend\n"),
      {"'Material solid/Young modulus': 100 there, 200 here"});
  has("a run with settings goes on", run(short_run), {"8 steps"});
}

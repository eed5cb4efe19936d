// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 4

// Checks runs that resume from a checkpoint or begin with another run, the
// treatment of earlier results, and folders in use.
#include <greville/base/run_folder.h>
#include <greville/run/run.h>

#include "simulation.h"
#include <algorithm>
#include <csignal>
#include <regex>
#include <unistd.h>

namespace
{
  const MPI_Comm comm = MPI_COMM_WORLD;

  bool
  is_first()
  {
    return Utilities::MPI::this_mpi_process(comm) == 0;
  }

  std::string
  content_of(const std::string &file)
  {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }

  std::size_t
  n_files(const std::string &folder, const std::string &begin)
  {
    std::size_t n = 0;
    for (const auto &entry : std::filesystem::directory_iterator(folder))
      n += entry.path().filename().string().rfind(begin, 0) == 0;
    return n;
  }

  /// Run the text in a folder. Returns the message of its error.
  std::string
  run(const Text        &text,
      const std::string &folder,
      const RunOptions  &options = RunOptions())
  {
    if (is_first())
      std::ofstream("run.prm")
        << text.with("Output", {"Directory = " + folder}).content;
    MPI_Barrier(comm);
    std::streambuf *const buffer = std::cout.rdbuf(nullptr);
    std::string           message;
    try
      {
        run_simulations("run.prm", comm, options);
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    std::cout.rdbuf(buffer);
    std::cout.clear();
    MPI_Barrier(comm);
    return message;
  }

  std::string
  resume(const Text &text, const std::string &folder)
  {
    RunOptions options;
    options.resumes = true;
    return run(text, folder, options);
  }

  void
  check_message(const std::string &what,
                const std::string &message,
                const std::string &wanted)
  {
    check(what + ": " + message, message.find(wanted) != std::string::npos);
  }



  /// A run in two parts is the same as one in one part.
  void
  test_same_files(const std::string &name, const Text &text)
  {
    const auto until = [&](const unsigned int n_steps) {
      return text.with("Time", {"Maximum steps = " + std::to_string(n_steps)});
    };
    check(name + ", whole run", run(until(40), "whole").empty());
    check(name + ", first part", run(until(20), "parts").empty());
    check(name + ", second part", resume(until(40), "parts").empty());
    for (const std::string file : {"statistics.csv", "probes.csv"})
      {
        const std::string whole = content_of("whole/" + file);
        check(name + ", lines of " + file,
              std::count(whole.begin(), whole.end(), '\n') > 30);
        check(name + ", " + file, whole == content_of("parts/" + file));
      }
    // The end of the first part is written, too.
    check(name + ", files of points",
          n_files("parts", "points_") >= n_files("whole", "points_"));
    check(name + ", two checkpoints",
          n_files("parts", "checkpoint_") == 2 &&
            std::filesystem::exists("parts/checkpoint_0000000040.h5"));
  }
} // namespace



void
test_main()
{
  if (is_first())
    for (const std::string folder : {"whole", "parts", "next", "used"})
      std::filesystem::remove_all(folder);
  const Text text =
    block_2d("box(0.2, 0, 0.6, 0.4)", 10)
      .with("Loads", {"Gravity = 1; -20"})
      .with("Walls", {"Bottom = fixed"})
      .with("Time", {"End = 10"})
      .with("Output", {"Probes = 0.3, 0.3", "Statistics every = 0"})
      .with("Checkpoints", {"Every steps = 10"});
  test_same_files("lumped", text);
  test_same_files("domains",
                  text.with("Scheme",
                            {"Mass = consistent", "Functions = domains"}));
  // The acceleration goes on at points, and on the grid.
  for (const std::string formulation :
       {"updated Lagrangian", "total Lagrangian"})
    test_same_files("implicit, " + formulation,
                    text
                      .with("Scheme",
                            {"Mass = consistent",
                             "Formulation = " + formulation,
                             "Stress update = generalized-alpha"})
                      .with("Loads", {"Body force = x - X; 0"})
                      .with("Time", {"Step = 0.01"}));
  test_same_files("a grid per body",
                  text.with("Simulation", {"Bodies = body, other"})
                    .with("Body other",
                          {"Material = solid", "Shape = ball(0.7, 0.6, 0.15)"})
                    .with("Grid", {"Per body = true"})
                    .with("Scheme", {"Formulation = total Lagrangian"}));

  // Earlier results: aside, one folder for each time; other files stay.
  if (is_first())
    std::ofstream("parts/notes.txt") << "mine";
  MPI_Barrier(comm);
  const Text few = text.with("Time", {"Maximum steps = 12"});
  check("another run", run(few, "parts").empty());
  check("moved aside",
        std::filesystem::exists("parts/earlier_5/checkpoint_0000000040.h5"));
  check("other files stay", content_of("parts/notes.txt") == "mine");
  check_message("refused",
                run(few.with("Output", {"Earlier results = refuse"}), "parts"),
                "has results of an earlier run");
  check(
    "removed",
    run(few.with("Output", {"Earlier results = remove"}), "parts").empty() &&
      !std::filesystem::exists("parts/earlier_6"));

  // Parameters that may change, and others.
  const Text more = text.with("Time", {"Maximum steps = 16"});
  check_message("a parameter that has changed",
                resume(more.with("Loads", {"Gravity = 0; -20"}), "parts"),
                "'Loads/Gravity': 1; -20 there, 0; -20 here");
  check_message("columns that have changed",
                resume(more.with("Output", {"Probes = 0.3, 0.3; 0.4, 0.3"}),
                       "parts"),
                "'Output/Probes'");
  check_message("no checkpoint", resume(more, "nowhere"), "no checkpoint");
  // A run that has come to its end does so again, beside what others have put
  // into its folder.
  if (is_first())
    {
      std::ofstream("parts/checkpoint_copy.h5") << "mine";
      std::ofstream("parts/files/points_99999999999999999999.vtu") << "mine";
      std::filesystem::create_directory("parts/checkpoint_0000000099.h5");
    }
  MPI_Barrier(comm);
  check("at its end", resume(few, "parts").empty());
  check("a folder is no checkpoint",
        std::filesystem::exists("parts/checkpoint_0000000099.h5.refused"));
  if (is_first())
    {
      std::filesystem::rename("parts/probes.csv", "probes.csv");
      std::filesystem::create_directory("parts/probes.csv");
    }
  MPI_Barrier(comm);
  check_message("a folder in the place of a file",
                resume(more, "parts"),
                "Cannot read <parts/probes.csv>: ");
  if (is_first())
    {
      std::filesystem::remove("parts/probes.csv");
      std::filesystem::rename("probes.csv", "parts/probes.csv");
    }
  MPI_Barrier(comm);

  // The newest checkpoint is broken: the one before is taken.
  if (is_first())
    std::filesystem::resize_file("parts/checkpoint_0000000012.h5", 5000);
  MPI_Barrier(comm);
  check("a broken checkpoint", resume(more, "parts").empty());
  check("one new and one old checkpoint",
        std::filesystem::exists("parts/checkpoint_0000000016.h5") &&
          std::filesystem::exists("parts/checkpoint_0000000010.h5"));
  check("a copy stays", content_of("parts/checkpoint_copy.h5") == "mine");

  // A new run from the end of another, on another grid with other walls.
  RunOptions from;
  from.from       = "whole";
  const Text next = text.with("Grid", {"Cells = 12, 12", "Order = 3"})
                      .with("Walls", {"Bottom = free"})
                      .with("Loads", {"Gravity = 0; 0"})
                      .with("Time", {"Start = 5", "End = 6"})
                      .with("Time", {"Maximum steps = 3"});
  check_message("no such run",
                run(next,
                    "next",
                    [] {
                      RunOptions options;
                      options.from = "nowhere";
                      return options;
                    }()),
                "There is no folder <nowhere>, and no checkpoint");
  check_message("another geometry",
                run(next.with("Grid", {"Geometry = axisymmetric"}),
                    "next",
                    from),
                "'Grid/Geometry' is <plane strain> there and <axisymmetric> "
                "here");
  Text another = next;
  for (const std::string name : {"Body body", "Bodies = body"})
    another.content =
      std::regex_replace(another.content,
                         std::regex(name),
                         name.substr(0, name.size() - 4) + "another");
  check_message("its own folder",
                run(next, "whole", from),
                "--from names the folder <whole> of this run itself");
  check("its results are still there",
        std::filesystem::exists("whole/checkpoint_0000000040.h5"));
  check_message("another body",
                run(another, "next", from),
                "it has no body another, but body body, body other.");
  check("the run before",
        run(text.with("Time", {"Maximum steps = 40"}), "whole").empty());
  const std::string message = run(next, "next", from);
  check("begin with another run: " + message, message.empty());
  {
    const auto last_of = [&](const std::string &file, const bool first) {
      const auto lines = Utilities::split_string_list(content_of(file), '\n');
      return Utilities::string_to_double(
        Utilities::split_string_list(first ? lines[1] : lines.back(), ','));
    };
    const auto end   = last_of("whole/statistics.csv", false),
               begin = last_of("next/statistics.csv", true);
    check("time", std::abs(begin[0] - 5.), 1e-12);
    // Mass and strain energy are those of the last row; momenta, angular
    // momentum and kinetic energy those of the steps, whose velocities it has.
    Simulated<2> same(text.with("Time", {"Maximum steps = 40"}));
    const auto   of_steps = same.run()->statistics().values();
    for (const unsigned int k : {2, 3, 4, 5, 6, 7})
      {
        const double expected = k == 2 || k == 7 ? end[k] : of_steps[k];
        check("column " + std::to_string(k),
              std::abs(begin[k] - expected),
              1e-10 * (1. + std::abs(expected)));
      }
  }

  // Other loads, and another transfer; another law of the material is refused.
  const Text pulled        = next.with("Loads", {"Body force = 0; 20"});
  const auto last_momentum = [&]() {
    const auto lines =
      Utilities::split_string_list(content_of("next/statistics.csv"), '\n');
    return Utilities::string_to_double(
      Utilities::split_string_list(lines.back(), ','));
  };
  {
    const auto without = last_momentum();
    check("with a body force", run(pulled, "next", from).empty());
    const auto with = last_momentum();
    // Time, dt, mass, momenta: what the force gives in this time.
    check("momentum of the body force",
          std::abs(with[4] - without[4] - 3.2 * (with[0] - 5.)),
          0.3 * 3.2 * (with[0] - 5.));
    check(
      "APIC",
      run(pulled.with("Scheme", {"Transfer = APIC"}), "next", from).empty());
  }
  check_message("another material",
                run(next.with("Material solid",
                              {"Model = drucker-prager",
                               "Friction angle = 30"}),
                    "next",
                    from),
                "its material or its initial state differs");

  // A signal ends a run, which goes on.
  {
    // An alarm raises it on one process while the run is there, which is when
    // the run takes the signal.
    struct sigaction action = {};
    action.sa_handler       = [](int) {
      struct sigaction now = {};
      sigaction(SIGTERM, nullptr, &now);
      if (now.sa_handler == SIG_DFL)
        ualarm(300000, 0);
      else
        std::raise(SIGTERM);
    };
    sigaction(SIGALRM, &action, nullptr);
    if (is_first())
      ualarm(300000, 0);
    const std::string stopped =
      run(text.with("Time", {"Maximum steps = 1000000", "Step = 1e-6"})
            .with("Checkpoints", {"Every steps = 0"}),
          "used");
    check_message("stopped", stopped, "Stopped by SIGTERM after step");
    check("files of a stopped run",
          std::filesystem::exists("used/summary.json") &&
            n_files("used", "checkpoint_") > 0);
  }

  // A folder in use.
  {
    const RunFolder folder("used",
                           "Output/Directory",
                           EarlierResults::keep,
                           comm);
    check("lock", content_of("used/lock").find("process ") == 0);
    check_message("in use",
                  run(few, "used"),
                  "is in use by another run: process");
    check("the lock is still there", std::filesystem::exists("used/lock"));
    MPI_Barrier(comm);
  }
  MPI_Barrier(comm);
  check("no lock", !std::filesystem::exists("used/lock"));
  check("free again", run(few, "used").empty());
}

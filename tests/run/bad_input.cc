// SPDX-License-Identifier: LGPL-2.1-or-later

// Each kind of wrong input is answered by one clear message, and a run that
// breaks stops with step, time and point, and leaves its last good state.
#include <greville/run/run.h>

#include "simulation.h"

namespace
{
  void
  test_in(const std::string &what,
          const Text        &text,
          const std::string &directory)
  {
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::ofstream("bad.prm")
        << text.content << "subsection Output\n  set Directory = " << directory
        << "\n  set Print times = false\nend\n";
    MPI_Barrier(MPI_COMM_WORLD);
    // The header is that of a good run.
    std::streambuf *const buffer = std::cout.rdbuf(nullptr);
    std::string           message;
    try
      {
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
    // What differs from machine to machine.
    const auto free = message.find(" of memory, and ");
    if (free != std::string::npos)
      message = message.substr(0, free) + " of memory";
    print() << "-- " << what << '\n' << message << '\n' << std::endl;
  }

  void
  test(const std::string &what, const Text &text)
  {
    test_in(what, text, "bad_results");
  }
} // namespace



void
test_main()
{
  const Text good = block_2d("box(0.25, 0.25, 0.75, 0.75)", 4)
                      .with("Time", {"End = 0.02", "Step = 0.01"})
                      .with("Material solid", {"Young modulus = 10"});
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
  test("traction on marked points",
       good.with("Simulation", {"Tractions = pull"})
         .with("Traction pull",
               {"Shape = ball(0.5, 0.5, 1)", "Traction = 1; 0", "Area = 1"}));
  test("friction of a wall without it",
       good.with("Walls", {"Top = fixed", "Top friction = 0.3"}));
  test("front wall in 2D", good.with("Walls", {"Front = fixed"}));
  test("surface without K0", good.with("Body body", {"Surface = 1"}));
  test("unknown mass", good.with("Scheme", {"Mass = lumpd"}));
  test("a solver for a mass", good.with("Scheme", {"Mass = cg-jacobi"}));
  test("p-multigrid without its method",
       good.with("p-multigrid", {"Smoother = jacobi"}));
  test("a parameter of cycles that only benchmarks have",
       good.with("Solver", {"Method = cg-p-multigrid"})
         .with("p-multigrid", {"Coarse tolerance = 0.1"}));
  for (const std::string mass : {"consistent", "fmpm-2"})
    test("APIC with the mass " + mass,
         good.with("Scheme", {"Transfer = APIC", "Mass = " + mass}));
  test("APIC with a reconstruction",
       good.with("Scheme", {"Transfer = APIC", "Quadrature = least-squares"}));
  test("moving wall without velocity", good.with("Walls", {"Top = moving"}));
  test("wall that moves along its normal",
       good.with("Walls", {"Top = moving", "Top velocity = 0; -1e4"}));
  test("points that follow a velocity",
       good.with("Body body", {"Imposed velocity = 0; min(1, t)"}));
  test("velocity of a wall that does not move",
       good.with("Walls", {"Top velocity = 1; 0"}));
  test("one periodic wall", good.with("Walls", {"Left = periodic"}));
  test(
    "few cells between periodic walls",
    good.with("Walls", {"Bottom = free", "Left = periodic", "Right = periodic"})
      .with("Grid", {"Order = 4"}));
  test("body over its image across periodic walls",
       good.with("Walls", {"Left = periodic", "Right = periodic"})
         .with("Body body", {"Shape = box(-0.3, 0, 1, 0.2)"}));
  test("wall that is periodic in a stage only",
       Text(good.with("Simulation", {"Stages = first, second"}).content +
            "subsection Stage first\n  subsection Time\n    set End = 0.02\n"
            "  end\nend\nsubsection Stage second\n  subsection Time\n"
            "    set End = 0.04\n  end\n  subsection Walls\n"
            "    set Left = periodic\n    set Right = periodic\n  end\nend\n"));
  {
    // Two bodies, of which the other one comes or goes.
    const Text two =
      good.with("Simulation", {"Bodies = body, other", "Stages = one, two"})
        .with("Body other",
              {"Material = solid", "Shape = box(0, 0.75, 0.25, 1)"});
    const auto staged = [&](const std::string &one, const std::string &two) {
      return "subsection Stage one\n  set " + one +
             "\n  subsection Time\n    set End = 0.02\n  end\nend\n"
             "subsection Stage two\n  set " +
             two + "\n  subsection Time\n    set End = 0.04\n  end\nend\n";
    };
    const auto in_stages = [&](const std::string &a, const std::string &b) {
      return Text(two.content + staged(a, b));
    };
    test("stage with an unknown body",
         in_stages("Bodies = body, others", "Bodies = all"));
    test("stage without a body", in_stages("Bodies =", "Bodies = all"));
    test("body in no stage", in_stages("Bodies = body", "Bodies = body"));
    test("body twice in a stage",
         in_stages("Bodies = body, body", "Bodies = all"));
    {
      Text three = two.with("Simulation", {"Stages = one, two, three"});
      three.content +=
        staged("Bodies = all", "Bodies = body") +
        "subsection Stage three\n  subsection Time\n    set End = 0.06\n"
        "  end\nend\n";
      test("body that comes back", three);
    }
    test("body of a later stage in the place of another",
         Text(two.with("Body other", {"Shape = ball(0.5, 0.5, 0.2)"}).content +
              staged("Bodies = body", "Bodies = all")));
    test("body of a later stage outside of the grid",
         Text(
           two.with("Body other", {"Shape = box(0.9, 0.9, 1.2, 1)"}).content +
           staged("Bodies = body", "Bodies = all")));
    test("body that comes in total Lagrangian steps",
         Text(two.with("Scheme", {"Formulation = total Lagrangian"}).content +
              staged("Bodies = body", "Bodies = all")));
    test("body that comes in a contact",
         Text(two.with("Simulation", {"Contacts = touch"})
                .with("Contact touch", {"Bodies = body, other"})
                .content +
              staged("Bodies = body", "Bodies = all")));
    test("material without a body",
         in_stages("Materials = solid", "Bodies = all"));
    test("material of an unknown body",
         in_stages("Materials = bodi: solid", "Bodies = all"));
    test("unknown material of a stage",
         in_stages("Materials = body: sold", "Bodies = all"));
    test("two materials of a body",
         in_stages("Materials = body: solid, body: solid", "Bodies = all"));
  }
  test("grid upside down", good.with("Grid", {"Upper corner = 1, -1"}));
  test("three numbers in 2D", good.with("Grid", {"Cells = 4, 4, 4"}));
  test("sweep that does not fit",
       good.with("Grid", {"Cells = 4, 3"}).with("Sweep", {"Cells = 5"}));
  test("no place for probes", good.with("Output", {"Probes = 1"}));
  test("K0 without gravity",
       good.with("Body body", {"K0 = 0.5", "Surface = 1"}));
  test("stress and K0",
       good.with("Body body",
                 {"K0 = 0.5", "Surface = 1", "Stress = 1; 1; 1; 0"}));

  // What muParser or other programs accept without a word
  test("decimal comma", good.with("Body body", {"Velocity = 0,5; 0"}));
  test("assignment", good.with("Loads", {"Gravity = t = 3; 0"}));
  test("infinite velocity",
       good.with("Body body", {"Velocity = 1 / x; 0 / 0"}));
  test("body force of NaN",
       good.with("Loads", {"Body force = sqrt(0.5 - x); 0"}));
  test("body force of NaN later",
       good.with("Loads", {"Body force = sqrt(0.005 - t); 0"}));
  test("infinite velocity of a wall",
       good.with("Walls", {"Top = moving", "Top velocity = 1 / t; 0"}));
  test("exact solution of NaN",
       good.with("Exact solution", {"Displacement = 0; log(-X)"}));
  test("traction of NaN",
       good.with("Simulation", {"Surface loads = pull"})
         .with("Body body", {"Placement = fitted"})
         .with("Surface load pull",
               {"Body = body", "Where = x > 0.74", "Traction = 0; 0 / 0"}));
  test("overflowing load", good.with("Loads", {"Body force = 9e99; 9e99"}));
  test("load that breaks a step", good.with("Loads", {"Body force = 4e11; 0"}));
  test("gravity that breaks a step", good.with("Loads", {"Gravity = 0; -1e9"}));
  test("number beyond reason", good.with("Time", {"CFL number = 1e300"}));
  test("surface of NaN",
       good.with("Loads", {"Gravity = 0; -1"})
         .with("Body body", {"K0 = 0.5", "Surface = 0 / 0"}));
  test("surface below the body",
       good.with("Loads", {"Gravity = 0; -1"})
         .with("Body body", {"K0 = 0.5", "Surface = 0.4"}));
  test("gravity upwards",
       good.with("Loads", {"Gravity = 0; 1"})
         .with("Body body", {"K0 = 0.5", "Surface = 0.75"}));
  test("two bodies in the same place",
       good.with("Simulation", {"Bodies = body, other"})
         .with("Body other",
               {"Material = solid", "Shape = ball(0.5, 0.5, 0.2)"}));
  {
    // Half a cell thick, and with other points.
    const Text thin =
      good.with("Simulation", {"Bodies = body, other"})
        .with("Body body", {"Shape = box(0.25, 0, 0.75, 0.12)"});
    const auto other = [&](const std::string &shape) {
      return thin.with("Body other",
                       {"Material = solid",
                        "Points per direction = 3",
                        "Shape = " + shape});
    };
    test("two thin bodies in the same place",
         other("box(0.25, 0, 0.75, 0.12)"));
    test("a thin body in another one", other("box(0.5, 0.03, 0.6, 0.1)"));
    test("two thin bodies that share cells",
         other("box(0.25, 0.12, 0.75, 0.24)"));
    test("a body on a slope",
         thin
           .with("Body body",
                 {"Shape = half_space(-0.3, 1, 0.1)",
                  "Clip at the grid = true"})
           .with("Body other",
                 {"Material = solid",
                  "Points per direction = 3",
                  "Shape = intersection(half_space(0.3, -1, -0.1), box(0, 0, "
                  "1, 0.6))"}));
  }
  test("share of FLIP with PIC",
       good.with("Scheme", {"Transfer = PIC", "FLIP share = 0.5"}));
  test("probe of NaN", good.with("Output", {"Probes = nan, nan"}));
  test("probe outside of the body", good.with("Output", {"Probes = 9, 9"}));
  test("negative radius",
       good.with("Body body", {"Shape = ball(0.5, 0.5, -0.2)"}));
  test("half space without a normal",
       good.with("Body body", {"Shape = half_space(0, 0, 1)"}));
  test("friction wall without a coefficient",
       good.with("Walls", {"Bottom = friction"}));
  test("a mass twice", good.with("Sweep", {"Masses = lumped, lumped"}));
  test("cells twice", good.with("Sweep", {"Cells = 4, 8, 4"}));
  test("tiny step", good.with("Time", {"Step = 1e-30"}));
  test("step lost to rounding",
       good.with("Time", {"Step = 1e-300", "Maximum steps = 3"}));
  test("automatic step lost to rounding",
       good.with("Time", {"Step =", "Safety = 1e-30", "Maximum steps = 3"}));
  test("tiny safety", good.with("Time", {"Step =", "Safety = 1e-30"}));
  test("name with a slash", good.with("Simulation", {"Name = ../other"}));
  test_in("folder with dots", good, "bad/../../other");
  test("PETSc options without a dash",
       good.with("Smoother", {"PETSc options = pc_type icc"}));
  test("grid beyond reason", good.with("Grid", {"Cells = 100000, 100000"}));
  test("sweep beyond reason", good.with("Sweep", {"Cells = 400000"}));

  // Names
  test("misspelled material", good.with("Simulation", {"Materials = solids"}));
  test("material without a section",
       good.with("Simulation", {"Materials = solid, water"}));
  test("section without a name",
       good.with("Material water", {"Model = newtonian-fluid"}));
  test("misspelled section", good.with("Wals", {"Top = fixed"}));
  test("parameter of another section", good.with("Time", {"Order = 2"}));
  test("misspelled word", good.with("Scheme", {"Transfer = FLP"}));
  test("whole number", good.with("Grid", {"Order = 1.5"}));
  test("truth", good.with("Output", {"Grid fields = maybe"}));
  test("file of the other program",
       Text().add("Benchmark", {"Orders = 2"}).add("Output", {}));
  test("no form", Text("subsection Time\n  End = 1\nend\n"));
  test("no end", Text("subsection Time\n"));
  test("one end too many", good.with("Time\nend", {}));

  // Texts of other systems
  test("byte order mark", Text("\xEF\xBB\xBF" + good.content));
  test("UTF-16", Text("\xFF\xFEs" + std::string("\0u\0b\0", 6)));
  test("Latin-1", good.with("Simulation", {"Name = B\xF6schung"}));
  test("UTF-8", good.with("Simulation", {"Name = B\xC3\xB6schung"}));
  test("Latin-1 in a comment", Text("# B\xF6schung\n" + good.content));
  const auto replaced = [&](const std::string &word, const std::string &other) {
    std::string text = good.content;
    return Text(text.replace(text.find(word), word.size(), other));
  };
  test("capitals", replaced("subsection Simulation", "SUBSECTION SIMULATION"));
  test("small letters", replaced("Grid", "grid"));
  test("a device", Text("include /dev/zero\n" + good.content));
  test_in("folder of the user", good, "~/results");
  const Text from_csv =
    good.with("Body body", {"Shape =", "Points file = p.csv"});
  for (const std::string begin : {"\xEF\xBB\xBF", "\xF6"})
    {
      if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        std::ofstream("p.csv")
          << begin << "x,y,volume\n0.5,0.5,0.01\n0.6,0.5,0.01\n";
      MPI_Barrier(MPI_COMM_WORLD);
      test("CSV with other bytes", from_csv);
    }
  test("CSV that is a device",
       good.with("Body body", {"Shape =", "Points file = /dev/zero"}));
  {
    const std::string message =
      message_of(ExcMessage("is <" + std::string(100000, 'x') + ">; no"));
    check("the begin of a long message", message.compare(0, 4, "is <") == 0);
    check("its end", message.substr(message.size() - 5) == ">; no");
    check("its length", message.size() < 4000);
  }

  // Files that cannot be written
  {
    const bool first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    const auto put   = [&](const std::string &target, const std::string &link) {
      MPI_Barrier(MPI_COMM_WORLD);
      if (first)
        {
          std::filesystem::remove_all("full");
          std::filesystem::create_directories("full");
          if (!link.empty())
            std::filesystem::create_symlink(target, "full/" + link);
        }
      MPI_Barrier(MPI_COMM_WORLD);
    };
    const Text full =
      good.with("Output", {"Probes = 0.5, 0.5", "Fields every = 0.01"});
    for (const std::string file : {"statistics.csv",
                                   "probes.csv",
                                   "summary.json.tmp",
                                   "parameters.prm.tmp",
                                   "points_0001.pvtu",
                                   "points.pvd.tmp"})
      {
        put("/dev/full", file);
        test_in("disk full: " + file, full, "full");
      }
    if (first)
      std::ofstream("a_file");
    test_in("folder that is a file", good, "a_file");
    test_in("folder below a file", good, "a_file/results");
  }

  // Runs that break
  const Text flying =
    good.with("Body body", {"Velocity = 9; 0"})
      .with("Time", {"End = 1", "Step = 0.01", "Too large step = ignore"});
  test("point leaves the grid", flying);
  {
    const bool first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    check("the last good state is there",
          !first || std::filesystem::exists("bad_results/points_0000.pvtu"));
  }
  test("points may leave the grid",
       flying.with("Scheme", {"Points outside = remove"}));
  test("negative volume",
       good.with("Body body", {"Velocity = -30 * (x - 0.5); -30 * (y - 0.5)"})
         .with("Time", {"End = 1", "Step = 0.05", "Too large step = ignore"}));
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// All: 1 2 4

// Checks periodic walls: a body flies through them as in an open grid, and
// results do not depend on where a period begins.
#include "simulation.h"
#include <algorithm>

// The results of a run: energies after each step, and the points by their id:
// displacement, velocity, stress.
struct History
{
  std::vector<double> energies, points;
  Tensor<1, 2>        momentum;
  double              kinetic = 0.;
};

using Levels = TangentParameters::UseOfLevels;

History
history_of(const Text &text, const Levels levels = Levels::automatic)
{
  Simulated<2> run(text, [&](SimulationParameters &parameters) {
    parameters.implicit_solver.use_of_levels = levels;
  });
  History      result;
  const auto   add = [&]() {
    const auto s = run->statistics();
    result.energies.push_back(s.kinetic);
    result.energies.push_back(s.strain);
    result.momentum = s.momentum;
    result.kinetic  = s.kinetic;
  };
  add();
  while (!run->is_finished())
    {
      run->step();
      add();
    }

  // Points are the same where their numbers are; ids are those of the grid.
  std::vector<std::array<double, 7>> own;
  for (const auto &body : run->bodies())
    body.points.for_each([&](const unsigned int, const auto p) {
      own.push_back({{p.position(0) - p.reference(0),
                      p.position(1) - p.reference(1),
                      p.velocity(0),
                      p.velocity(1),
                      p.stress(0),
                      p.stress(1),
                      p.reference(1)}});
    });
  const auto gathered = Utilities::MPI::all_gather(MPI_COMM_WORLD, own);
  std::vector<std::array<double, 7>> all;
  for (const auto &part : gathered)
    all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  for (const auto &point : all)
    result.points.insert(result.points.end(), point.begin(), point.end());
  return result;
}

// The largest difference, relative to the largest number.
double
relative(const std::vector<double> &a, const std::vector<double> &b)
{
  if (a.size() != b.size())
    return 1.;
  double error = 0., size = 0.;
  for (unsigned int k = 0; k < a.size(); ++k)
    {
      error = std::max(error, std::abs(a[k] - b[k]));
      size  = std::max(size, std::abs(b[k]));
    }
  return error / size;
}

// A block of 4 x 3 cells of 0.1 m at x = begin that vibrates, with the speed v.
Text
block(const double       begin,
      const unsigned int n,
      const bool         periodic,
      const double       v,
      const unsigned int p,
      const double       end)
{
  const auto N = [](const double x) {
    std::ostringstream text;
    text << std::setprecision(16) << x;
    return text.str();
  };
  return block_2d("")
    .with("Grid",
          {"Upper corner = " + N(0.1 * n) + ", 1",
           "Cells = " + std::to_string(n) + ", 10",
           "Order = " + std::to_string(p)})
    .with("Body body",
          {"Shape = box(" + N(begin) + ", 0.31, " + N(begin + 0.4) + ", 0.62)",
           "Points per direction = 3",
           "Velocity = " + N(v) + " + 0.2 * (x - " + N(begin + 0.1) +
             "); 0.1 * (x - " + N(begin) + ") - 0.1 * (y - 0.4)"})
    .with("Walls",
          {std::string("Left = ") + (periodic ? "periodic" : "free"),
           std::string("Right = ") + (periodic ? "periodic" : "free")})
    .with("Time", {"End = " + N(end), "Step = 0.0008"})
    .with("Solver", {"Tolerance = 1e-13"});
}



void
test_main()
{
  using Lines = std::vector<std::string>;
  const std::vector<std::pair<std::string, Lines>> schemes = {
    {"lumped", {"Mass = lumped"}},
    {"lumped, MUSL, FLIP and PIC",
     {"Mass = lumped", "Stress update = MUSL", "FLIP share = 0.99"}},
    {"lumped, MUSL, APIC",
     {"Mass = lumped", "Stress update = MUSL", "Transfer = APIC"}},
    {"fmpm-4", {"Mass = fmpm-4"}},
    {"lumped, projected volume",
     {"Mass = lumped", "Volumetric projection = order p-1"}},
    {"consistent", {"Mass = consistent"}},
    {"consistent, MUSL", {"Mass = consistent", "Stress update = MUSL"}},
    {"consistent, no filter", {"Mass = consistent", "Filter = 0"}}};

  // The filter amplifies round-off, in open grids, too.
  const auto bound = [](const std::string &scheme) {
    return scheme == "consistent" || scheme == "consistent, MUSL" ? 1e-6
                                                                  : 1e-10;
  };

  // A block across the wall is the block in the middle.
  for (const auto &scheme : schemes)
    for (const unsigned int p : {1, 2, 3})
      {
        const std::string name =
          scheme.first + ", p = " + std::to_string(p) + ": ";
        std::vector<History> runs;
        for (const double begin : {0.32, 0.72, -0.08})
          runs.push_back(history_of(
            block(begin, 10, true, 0., p, 0.04).with("Scheme", scheme.second)));
        for (const unsigned int k : {1, 2})
          {
            check(name + "energies across the wall",
                  relative(runs[k].energies, runs[0].energies),
                  bound(scheme.first));
            check(name + "points across the wall",
                  relative(runs[k].points, runs[0].points),
                  bound(scheme.first));
          }
      }

  // Three periods of 0.8 m in a grid of 32 cells, and in a periodic one of 8.
  for (const auto &scheme : schemes)
    {
      std::vector<History> runs;
      for (const bool periodic : {false, true})
        runs.push_back(
          history_of(block(0.42, periodic ? 8 : 36, periodic, 8., 2, 0.3)
                       .with("Scheme", scheme.second)
                       .with("Scheme", {"Energy gain = ignore"})));
      const History &open = runs[0], &wrapped = runs[1];
      check(scheme.first + ": energies in flight",
            relative(wrapped.energies, open.energies),
            1e-8);
      check(scheme.first + ": momentum in flight",
            (wrapped.momentum - open.momentum).norm() / open.momentum.norm(),
            1e-10);
      print() << scheme.first << ": kinetic energy " << std::setprecision(6)
              << wrapped.kinetic << " J" << std::endl;
    }

  // Implicit steps, with levels, too.
  for (const std::string scheme : {"implicit-midpoint", "generalized-alpha"})
    for (const unsigned int p : {1, 2, 3})
      for (const auto &[levels, levels_name] :
           Choices<Levels>{{Levels::never, "smoother"},
                           {Levels::always, "p-multigrid"}})
        {
          const std::string name =
            scheme + ", p = " + std::to_string(p) + ", " + levels_name + ": ";
          const auto text = [&](const double       begin,
                                const unsigned int n,
                                const bool         periodic,
                                const double       v) {
            return block(begin, n, periodic, v, p, 0.12)
              .with("Scheme",
                    {"Mass = consistent", "Stress update = " + scheme})
              .with("Time", {"Step = 0.01"})
              .with("Material solid", {"Model = neo-hookean"})
              .with("Newton", {"Tolerance = 1e-9"});
          };
          const History middle = history_of(text(0.32, 10, true, 0.), levels);
          const History across = history_of(text(0.72, 10, true, 0.), levels);
          check(name + "energies across the wall",
                relative(across.energies, middle.energies),
                1e-8);
          const History open = history_of(text(0.42, 24, false, 10.), levels);
          const History wrapped = history_of(text(0.42, 8, true, 10.), levels);
          check(name + "energies in flight",
                relative(wrapped.energies, open.energies),
                1e-8);
        }

  // 3D: a block across an edge of two periodic directions, in flight through
  // both of them, keeps the velocity of its center; displacements go on.
  for (const std::string mass : {"lumped", "consistent"})
    for (const unsigned int p : {1, 2})
      {
        const Text cube =
          block_3d("box(0.6, 0.2, 0.65, 1.3, 0.8, 1.4)", 6)
            .with("Grid", {"Order = " + std::to_string(p)})
            .with("Body body", {"Velocity = 7; 0.1 * (y - 0.5); -6"})
            .with("Walls",
                  {"Left = periodic",
                   "Right = periodic",
                   "Back = periodic",
                   "Front = periodic"})
            .with("Scheme", {"Mass = " + mass})
            .with("Time", {"End = 0.2", "Step = 0.002"})
            .with("Solver", {"Tolerance = 1e-13"});
        Simulated<3> run(cube);
        const auto   start = run->statistics();
        run.run();
        const auto end    = run->statistics();
        double     sum[2] = {}, all = 0.;
        for (const auto &body : run->bodies())
          body.points.for_each([&](const unsigned int, const auto q) {
            for (unsigned int k = 0; k < 2; ++k)
              sum[k] += q.mass() * (q.position(2 * k) - q.reference(2 * k));
            all += q.mass();
          });
        const std::string name =
          "3D, " + mass + ", p = " + std::to_string(p) + ": ";
        check(name + "momentum",
              (end.momentum - start.momentum).norm() / start.momentum.norm(),
              1e-10);
        check(name + "displacement",
              std::abs(Utilities::MPI::sum(sum[0], MPI_COMM_WORLD) /
                         Utilities::MPI::sum(all, MPI_COMM_WORLD) -
                       1.4) +
                std::abs(Utilities::MPI::sum(sum[1], MPI_COMM_WORLD) /
                           Utilities::MPI::sum(all, MPI_COMM_WORLD) +
                         1.2),
              1e-9);
        // The filter of consistent mass amplifies round-off.
        if (mass == "lumped")
          print() << name << "strain energy " << std::setprecision(5)
                  << 1e6 * end.strain << " uJ" << std::endl;
        else
          check(name + "strain energy, uJ",
                std::abs(1e6 * end.strain - 38.),
                4.);
      }
}

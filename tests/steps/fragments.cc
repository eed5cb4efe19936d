// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks the exact mass matrix for bodies that are too small for it: a disk and
// a single point, which is a fragment, fall with the same velocity, so that no
// point has a stress. Factorizations are used for several steps.
#include "simulation.h"

void
test_main()
{
  const Text text =
    Text()
      .add("Simulation", {"Bodies = disk, point", "Materials = rubber"})
      .add("Grid", {"Cells = 10, 10"})
      .add("Time", {"End = 0.2", "CFL number = 0.2"})
      .add("Body disk",
           {"Material = rubber",
            "Shape = ball(0.37, 0.6, 0.26)",
            "Points per direction = 2"})
      .add("Body point",
           {"Material = rubber",
            "Shape = box(0.82, 0.82, 0.88, 0.88)",
            "Points per direction = 2"})
      .add("Material rubber",
           {"Model = neo-hookean",
            "Density = 1000",
            "Young modulus = 1000",
            "Poisson ratio = 0.3"})
      .add("Loads", {"Gravity = 0; -1"});
  for (const unsigned int p : {1, 2, 3})
    {
      Simulated<2> run(text.with("Grid", {"Order = " + std::to_string(p)}));
      const double start = run->statistics().center[1];
      run.run();
      print() << "p = " << p << std::endl;
      check("  there are fragments", run->mass().n_fragments() > 0);
      check("  free fall",
            std::abs(run->statistics().center[1] - start + 0.5 * 0.2 * 0.2),
            1e-10);
      check("  no stress", run->statistics().strain, 1e-12);
      check("  factorizations are reused",
            run->mass().n_factorizations() < run->state().n_steps);
    }
  // In other units the masses are those of bodies of nanometres: nothing else
  // changes.
  Simulated<2> tiny(
    text.with("Material rubber", {"Density = 1e-37", "Young modulus = 1e-37"}));
  const double start = tiny->statistics().center[1];
  tiny.run();
  check("tiny masses: there are fragments", tiny->mass().n_fragments() > 0);
  check("  free fall",
        std::abs(tiny->statistics().center[1] - start + 0.5 * 0.2 * 0.2),
        1e-10);

  // A strip of a fifth of a cell: the run says that it is too thin.
  for (const bool is_thin : {false, true})
    {
      Simulated<2> body(block_2d(is_thin ? "box(0.2, 0.51, 0.8, 0.53)"
                                         : "box(0.2, 0.2, 0.8, 0.8)",
                                 10)
                          .with("Scheme", {"Mass = consistent"}));
      body->step();
      const auto warnings = body->step_log().take_warnings();
      check(is_thin ? "thin bodies are warned of" : "others are not",
            is_thin ? warnings.size() == 1 &&
                        warnings[0].find("too thin") != std::string::npos
                    : warnings.empty());
    }
}

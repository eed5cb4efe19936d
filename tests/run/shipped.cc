// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Every shipped parameter file, those of the user guide and the examples of the
// reference parse, their files are there, their points can be made on a coarse
// grid, and doc/simulation_parameters.md is what the program says, with an
// example in each section.
#include <greville/base/templates.h>
#include <greville/steps/ensemble.h>

#include "../reference_page.h"
#include "simulation.h"

void
test_main()
{
  const std::filesystem::path root =
    std::filesystem::path(SOURCE_DIR).parent_path().parent_path();
  std::vector<std::filesystem::path> files;
  for (const char *folder :
       {"prm/simulation", "prm/simulation/sections", "doc/user/examples"})
    for (const auto &entry : std::filesystem::directory_iterator(root / folder))
      if (entry.path().extension() == ".prm")
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto &file : files)
    try
      {
        const SimulationParameters parameters(file.string());
        if (parameters.general.dimension == 2)
          {
            const MeasuredData<2>  measured(parameters.reference);
            const ExactSolution<2> exact(parameters.exact);
            Ensemble<2>            simulation(parameters);
            if (simulation.bodies()[0].n_points < 20000)
              simulation.step();
          }
        else
          {
            const ExactSolution<3> exact(parameters.exact);
            Ensemble<3>            simulation(parameters);
            if (simulation.bodies()[0].n_points < 20000)
              simulation.step();
          }
        check(file.filename().string(), true);
      }
    catch (const std::exception &error)
      {
        print() << file.filename().string() << ": " << message_of(error)
                << std::endl;
      }

  SimulationParameters::use_reference([&](const ParameterHandler &prm) {
    check_reference("greville",
                    prm,
                    simulation_examples(),
                    root / "doc" / "simulation_parameters.md");
  });
}

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// Debug: no

// Checks the axis-aligned manufactured solution (benchmark A8) of the shipped
// files on coarser grids.
#include "simulation.h"

template <int dim>
double
error_of(const std::string &file,
         const unsigned int n,
         const unsigned int p,
         const std::string &mass,
         const std::string &functions)
{
  SimulationParameters parameters(file);
  parameters.grid.cells.assign(dim, n);
  parameters.grid.degree      = p;
  parameters.scheme.mass      = mass;
  parameters.scheme.functions = functions;
  Simulation<dim> simulation(parameters);
  while (!simulation.is_finished())
    simulation.step();
  const double t = simulation.state().time;
  return ExactSolution<dim>(parameters.exact)
    .errors(simulation.bodies(), t, t, MPI_COMM_WORLD)
    .displacement->l2;
}



void
test_main()
{
  const std::string folder =
    std::string(SOURCE_DIR) + "/../../prm/simulation/axis_aligned_mms_";
  for (const unsigned int p : {2, 3})
    {
      const double coarse =
        error_of<2>(folder + "2d.prm", 4, p, "consistent", "domains");
      const double fine =
        error_of<2>(folder + "2d.prm", 8, p, "consistent", "domains");
      check("2D, domains, p = " + std::to_string(p) + ": order at least 1.5",
            std::log2(coarse / fine) > 1.5);
      check("2D, domains, p = " + std::to_string(p), fine, 5e-3);
    }
  const double points =
    error_of<2>(folder + "2d.prm", 8, 2, "consistent", "points");
  check("2D, points", points, 1e-2);
  const double lumped_4 =
    error_of<2>(folder + "2d.prm", 8, 2, "lumped", "points");
  const double lumped_8 =
    error_of<2>(folder + "2d.prm", 16, 2, "lumped", "points");
  check("2D, lumped: order at least 1.5", std::log2(lumped_4 / lumped_8) > 1.5);
  check("3D, domains",
        error_of<3>(folder + "3d.prm", 4, 2, "consistent", "domains"),
        3e-2);
}

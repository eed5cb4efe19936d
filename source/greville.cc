// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/program.h>
#include <greville/simulation/run.h>

int
main(int argc, char **argv)
{
  greville::Program program;
  program.name = "greville";
  program.purpose =
    "the material point method on B-splines: runs the simulation, or the "
    "sweep of simulations, of a parameter file";
  program.run = [](const std::string &file) {
    greville::run_simulations(file, MPI_COMM_WORLD);
  };
  program.print_parameters = greville::SimulationParameters::print_reference;
  return greville::run_program(program, argc, argv);
}

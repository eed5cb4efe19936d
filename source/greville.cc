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
  program.options = {
    {"resume", "", "go on from the last checkpoint of its folder"},
    {"from", "FOLDER", "begin with the last checkpoint of another run"}};
  program.run = [](const std::string            &file,
                   const greville::GivenOptions &given) {
    greville::RunOptions options;
    options.resumes = given.count("resume") > 0;
    if (given.count("from") > 0)
      options.from = given.at("from");
    AssertThrow(!options.resumes || options.from.empty(),
                dealii::ExcMessage("--resume and --from exclude each other: a "
                                   "run goes on, or begins with another one."));
    greville::run_simulations(file, MPI_COMM_WORLD, options);
  };
  program.print_parameters = greville::SimulationParameters::print_reference;
  return greville::run_program(program, argc, argv);
}

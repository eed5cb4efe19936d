#include <greville/base/parameters.h>
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
  program.print_parameters = [](std::ostream &out) {
    const greville::SimulationParameters parameters;
    greville::print_parameter_reference(out, "greville");
  };
  return greville::run_program(program, argc, argv);
}

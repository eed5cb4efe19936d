// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/parameters.h>
#include <greville/base/program.h>
#include <greville/benchmark/mass_benchmark.h>

int
main(int argc, char **argv)
{
  greville::Program program;
  program.name = "mass_benchmark";
  program.purpose =
    "solves with mass matrices on B-splines: runs the sweeps of a parameter "
    "file and prints iterations and times";
  program.run = [](const std::string &file) {
    greville::MassBenchmark().run(file);
  };
  program.print_parameters = [](std::ostream &out) {
    greville::MassBenchmark  benchmark;
    dealii::ParameterHandler prm;
    benchmark.declare(prm);
    greville::print_parameter_reference(out, "mass_benchmark", prm);
  };
  return greville::run_program(program, argc, argv);
}

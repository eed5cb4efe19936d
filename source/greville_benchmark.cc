// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/parameters.h>
#include <greville/base/program.h>
#include <greville/benchmark/benchmark.h>

int
main(int argc, char **argv)
{
  greville::Program program;
  program.name = PROGRAM_NAME;
  program.purpose =
    "solves with mass, Laplace and elasticity matrices on B-splines: runs the "
    "sweeps of a parameter file and prints iterations and times";
  program.run = [](const std::string &file, const greville::GivenOptions &) {
    greville::Benchmark(PROGRAM_NAME).run(file);
  };
  program.print_parameters = [](std::ostream &out) {
    greville::Benchmark      benchmark;
    dealii::ParameterHandler prm;
    benchmark.declare(prm);
    greville::print_parameter_reference(out, "greville_benchmark", prm);
  };
  return greville::run_program(program, argc, argv);
}

// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/templates.h>
#include <greville/benchmark/benchmark.h>
#include <greville/benchmark/benchmark_program.h>

#include <sstream>

namespace greville
{
  Program
  benchmark_program()
  {
    Program program;
    program.name = "greville_benchmark";
    program.purpose =
      "solves linear systems with mass, Laplace and elasticity matrices of "
      "B-splines, and prints iterations and times";
    program.run = [](const std::string &file, const GivenOptions &given) {
      const auto settings = given.find("set");
      Benchmark("greville_benchmark")
        .run(file,
             settings == given.end() ? std::vector<std::string>()
                                     : settings->second);
    };
    program.all_parameters =
      [](const std::string                          &file,
         const std::vector<std::string>             &settings,
         const dealii::ParameterHandler::OutputStyle style) {
        Benchmark benchmark;
        if (!file.empty())
          return benchmark.read(file, settings, style);
        dealii::ParameterHandler prm;
        benchmark.declare(prm);
        std::ostringstream defaults;
        prm.print_parameters(defaults, style);
        return defaults.str();
      };
    program.reference = [](const UseParameters &use) {
      Benchmark                benchmark;
      dealii::ParameterHandler prm;
      benchmark.declare(prm);
      use(prm);
    };
    program.examples = benchmark_examples();
    program.lists    = {{"operators", "", operator_names},
                        {"mass-solvers", "", MassSolver<2>::names},
                        {"other-solvers", "", solvers_beside_mass},
                        {"smoothers", "p-multigrid/Smoother", {}},
                        {"cycles", "p-multigrid/Cycle", {}},
                        {"coarsenings", "p-multigrid/Coarsening", {}},
                        {"prolongations", "p-multigrid/Prolongation", {}},
                        {"restrictions", "p-multigrid/Restriction", {}}};
    return program;
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks that all shipped parameter files and all examples of the reference
// parse, and that doc/parameters.md agrees with the program and has an example
// in each section.

#include <greville/base/templates.h>
#include <greville/benchmark/benchmark.h>

#include "../reference_page.h"
#include <algorithm>
#include <filesystem>

void
test_main()
{
  const std::filesystem::path root =
    std::filesystem::path(SOURCE_DIR).parent_path().parent_path();

  std::vector<std::filesystem::path> files;
  for (const std::string folder : {"mass", "stiffness"})
    for (const auto &entry :
         std::filesystem::recursive_directory_iterator(root / "prm" / folder))
      if (entry.path().extension() == ".prm")
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto &file : files)
    {
      Benchmark        benchmark;
      ParameterHandler prm;
      benchmark.declare(prm);
      try
        {
          parse_parameter_lines(
            prm, read_parameter_lines(file.string(), "Benchmark", {}, ""));
          check(file.filename().string(), true);
        }
      catch (const std::exception &error)
        {
          print() << message_of(error) << std::endl;
        }
    }

  Benchmark        benchmark;
  ParameterHandler prm;
  benchmark.declare(prm);
  check_reference("greville_benchmark",
                  prm,
                  benchmark_examples(),
                  root / "doc" / "parameters.md");
}

// SPDX-License-Identifier: LGPL-2.1-or-later

// Every shipped parameter file parses, and doc/parameters.md is what the
// program says.

#include <greville/benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <tests.h>

int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const std::filesystem::path      root =
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

  Benchmark          benchmark;
  ParameterHandler   prm;
  std::ostringstream generated;
  benchmark.declare(prm);
  print_parameter_reference(generated, "greville_benchmark", prm);
  std::ifstream      page(root / "doc" / "parameters.md");
  std::ostringstream content;
  content << page.rdbuf();
  check("doc/parameters.md is up to date", content.str() == generated.str());
}

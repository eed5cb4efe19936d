// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/parameters.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <tests.h>

/// Check that the page of the reference agrees with the program, and that each
/// section has an example.
inline void
check_reference(const std::string           &program,
                const ParameterHandler      &prm,
                const std::string           &examples,
                const std::filesystem::path &page)
{
  std::ostringstream generated, content;
  print_parameter_reference(generated, program, prm, examples);
  content << std::ifstream(page).rdbuf();
  check(page.string() + " is up to date", content.str() == generated.str());

  std::istringstream lines(generated.str());
  std::string        section, above;
  for (std::string line; std::getline(lines, line);)
    {
      if (line.compare(0, 3, "## ") == 0)
        section = line;
      else if (line.compare(0, 12, "| parameter ") == 0)
        check(section + " has an example", above == "```");
      if (!line.empty())
        above = line;
    }
}

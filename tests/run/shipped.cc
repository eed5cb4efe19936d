// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// Debug: no

// Checks that all shipped parameter files of simulations, examples, the user
// guide and the reference are accepted, and that their data exist; rerun.cc
// runs them. doc/simulation_parameters.md must agree with the program, with an
// example in each section. It has at most 200 rows, and a law has at most 10.
// Some shipped file sets each of them, except PETSc
// options of a smoother that no file uses.
#include <greville/base/templates.h>

#include "../reference_page.h"
#include "../shipped_files.h"
#include "simulation.h"
#include <regex>
#include <set>

namespace
{
  using Parameter = std::pair<std::string, std::string>; // section and name



  /// The parameters that a file sets, as the reference names them.
  void
  collect(const std::filesystem::path &file, std::set<Parameter> &result)
  {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::map<std::string, std::string> variants;
    const auto lines = parameter_lines_of(text.str(), file.string());
    for (const ParameterLine &line : lines)
      if (line.name == "Model")
        variants[line.section] = " of model " + line.value;
      else if (line.name == "Kind")
        variants[line.section] = " of kind " + line.value;
    for (const ParameterLine &line : lines)
      {
        const std::string section = std::regex_replace(
          std::regex_replace(line.section, std::regex("^Stage [^/]+/"), ""),
          std::regex("^(Body|Material|Stage|Surface load|Rigid body|Contact|"
                     "Refinement) [^/]+"),
          "$1 NAME");
        result.emplace(section, section == "Formulas" ? "NAME" : line.name);
        if (section == "Surface load NAME" && variants[line.section].empty())
          variants[line.section] = " of kind traction";
        result.emplace(section + variants[line.section], line.name);
      }
  }



  /// The rows of the reference that no file sets, and their number.
  void
  check_rows(const std::filesystem::path &page, const std::set<Parameter> &set)
  {
    constexpr unsigned int largest_number = 200, most_of_law = 10;
    std::ifstream          lines(page);
    std::string            section;
    unsigned int           n_rows = 0;

    std::map<std::string, unsigned int> n_rows_of_laws;
    for (std::string line; std::getline(lines, line);)
      if (line.compare(0, 3, "## ") == 0)
        section = line.substr(3);
      else if (line.compare(0, 2, "| ") == 0 &&
               line.compare(0, 12, "| parameter ") != 0 &&
               line.compare(0, 5, "| ---") != 0)
        {
          ++n_rows;
          if (section.find(" of model ") != std::string::npos)
            ++n_rows_of_laws[section];
          const auto names =
            Utilities::split_string_list(line.substr(2, line.find(" |") - 2));
          check("a shipped file sets " + section + "/" + names[0],
                names[0] == "PETSc options" ||
                  std::any_of(names.begin(),
                              names.end(),
                              [&](const std::string &name) {
                                return set.count({section, name}) == 1;
                              }));
        }
    check("rows of the reference: " + std::to_string(n_rows),
          n_rows <= largest_number);
    for (const auto &[law, n] : n_rows_of_laws)
      check(law + ": " + std::to_string(n), n <= most_of_law);
  }



  /// The files of data that are compared with.
  template <int dim>
  void
  read_data(const SimulationParameters &parameters)
  {
    check_reference<dim>(parameters.reference);
    const ExactSolution<dim> exact(parameters.exact);
  }
} // namespace



void
test_main()
{
  const std::filesystem::path root =
    std::filesystem::path(SOURCE_DIR).parent_path().parent_path();
  std::set<Parameter> set;
  for (const char *folder : {"prm/simulation",
                             "prm/simulation/sections",
                             "doc/user/examples",
                             "doc/gallery"})
    for (const auto &entry : std::filesystem::directory_iterator(root / folder))
      if (entry.path().extension() == ".prm")
        collect(entry.path(), set);
  check_rows(root / "doc" / "simulation_parameters.md", set);

  // Before a plugin adds a law.
  SimulationParameters::use_reference([&](const ParameterHandler &prm) {
    check_reference("greville",
                    prm,
                    simulation_examples(),
                    root / "doc" / "simulation_parameters.md");
  });

  for (const auto &[file, libraries] :
       whole_shipped_files(SOURCE_DIR, BUILD_DIR))
    try
      {
        const SimulationParameters parameters(file.string(), libraries);
        check(file.string(), true);
        if (parameters.general.dimension == 2)
          read_data<2>(parameters);
        else
          read_data<3>(parameters);
      }
    catch (const std::exception &error)
      {
        print() << file.string() << ": " << message_of(error) << std::endl;
      }
}

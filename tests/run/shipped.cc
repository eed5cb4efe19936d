// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1
// Debug: no

// Every shipped parameter file, those of examples, of the user guide and of the
// reference parse, their files are there, their points can be made on a coarse
// grid, and doc/simulation_parameters.md is what the program says, with an
// example in each section. It has at most 176 rows besides those of laws, a law
// has at most 10, and some shipped file sets what each of them describes;
// options of PETSc are those of a smoother that none of them takes.
#include <greville/base/templates.h>
#include <greville/steps/ensemble.h>

#include "../reference_page.h"
#include "simulation.h"
#include <regex>
#include <set>

namespace
{
  using Parameter = std::pair<std::string, std::string>; // section and name



  /**
   * What a file sets, in the words of the reference.
   */
  void
  collect(const std::filesystem::path &file, std::set<Parameter> &result)
  {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::map<std::string, std::string> models;
    const auto lines = parameter_lines_of(text.str(), file.string());
    for (const ParameterLine &line : lines)
      if (line.name == "Model")
        models[line.section] = line.value;
    for (const ParameterLine &line : lines)
      {
        const std::string section = std::regex_replace(
          std::regex_replace(line.section, std::regex("^Stage [^/]+/"), ""),
          std::regex(
            "^(Body|Material|Stage|Surface load|Rigid body|Contact) [^/]+"),
          "$1 NAME");
        result.emplace(section, line.name);
        if (section == "Material NAME")
          result.emplace(section + " of model " + models[line.section],
                         line.name);
      }
  }



  /**
   * The rows of the reference that no file sets, and their number.
   */
  void
  check_rows(const std::filesystem::path &page, const std::set<Parameter> &set)
  {
    constexpr unsigned int largest_number = 176, most_of_law = 10;
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
          ++(section.find(" of model ") != std::string::npos
               ? n_rows_of_laws[section]
               : n_rows);
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
} // namespace



void
test_main()
{
  const std::filesystem::path root =
    std::filesystem::path(SOURCE_DIR).parent_path().parent_path();
  std::vector<std::filesystem::path> examples;
  for (const auto &entry :
       std::filesystem::directory_iterator(root / "examples"))
    if (entry.is_directory())
      examples.push_back(entry.path());
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

  std::vector<std::filesystem::path> files;
  std::vector<std::filesystem::path> folders = examples;
  for (const char *folder :
       {"prm/simulation", "prm/simulation/sections", "doc/user/examples"})
    folders.push_back(root / folder);
  for (const auto &folder : folders)
    for (const auto &entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".prm")
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto &file : files)
    try
      {
        // What users compile, from the tree of the build.
        std::vector<std::string> libraries;
        if (file.filename() == "umat.prm")
          libraries = {"Material sand/Library=" BUILD_DIR
                       "/libraries/mohr_coulomb_cc.so"};
        if (file.filename() == "plugin.prm")
          libraries = {"Simulation/Additional shared libraries=" BUILD_DIR
                       "/libraries/sponge.so"};
        SimulationParameters parameters(file.string(), libraries);
        parameters.newton.log = false;
        for (StageParameters &stage : parameters.stages)
          stage.newton.log = false;
        if (parameters.general.dimension == 2)
          {
            const MeasuredData<2>  measured(parameters.reference);
            const ExactSolution<2> exact(parameters.exact);
            Ensemble<2>            simulation(parameters);
            if (simulation.bodies()[0].n_points < 20000)
              simulation.step();
          }
        else
          {
            const ExactSolution<3> exact(parameters.exact);
            Ensemble<3>            simulation(parameters);
            if (simulation.bodies()[0].n_points < 20000)
              simulation.step();
          }
        check(file.filename().string(), true);
      }
    catch (const std::exception &error)
      {
        print() << file.filename().string() << ": " << message_of(error)
                << std::endl;
      }
}

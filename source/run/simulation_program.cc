// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/templates.h>
#include <greville/parameters/names.h>
#include <greville/run/run.h>
#include <greville/run/simulation_program.h>
#include <greville/steps/grid_mass.h>

#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <map>

namespace greville
{
  namespace
  {
    /// Return the parameter file in a folder of results, or the file itself.
    std::string
    file_to_run(const std::string &file, const bool resumes)
    {
      std::error_code none;
      if (!std::filesystem::is_directory(file, none))
        return file;
      const auto own         = std::filesystem::path(file) / "parameters.prm";
      const bool has_results = std::filesystem::exists(own, none);
      Require(has_results || !resumes,
              "The folder <" + file +
                "> has no results to resume from: there is no file <" +
                own.string() + ">.");
      Require(resumes || !has_results,
              "<" + file +
                "> is a folder with results, not a parameter file. --resume "
                "continues from them, and <" +
                own.string() + "> has their parameters.");
      return resumes ? own.string() : file;
    }



    void
    run_or_check(const std::string &given_file, const GivenOptions &given)
    {
      const std::string file =
        file_to_run(given_file, given.count("resume") > 0);
      const auto value = [&](const std::string &name) {
        return given.count(name) > 0 ? given.at(name)[0] : "";
      };
      RunOptions options;
      options.resumes = given.count("resume") > 0;
      options.from    = value("from");
      if (given.count("set") > 0)
        options.settings = given.at("set");
      Require(!options.resumes || options.from.empty(),
              "--resume and --from exclude each other: a run either continues "
              "or begins from another run.");
      Require(given.count("check") > 0 || given.count("draw") == 0,
              "--draw is for the initial state that --check makes: give both.");
      const bool is_test = given.count("element-test") > 0;
      Require(!is_test || (given.count("check") == 0 && !options.resumes &&
                           options.from.empty()),
              "--element-test runs no simulation: leave out --check, --resume "
              "and --from.");
      Require(is_test || given.count("material") == 0,
              "--material is for --element-test TEST: give both.");
      if (given.count("runs") > 0)
        prepare_sweep(file,
                      value("runs"),
                      MPI_COMM_WORLD,
                      options,
                      given.count("check") == 0);
      else if (is_test)
        run_element_test_of_file(file,
                                 value("element-test"),
                                 value("material"),
                                 MPI_COMM_WORLD,
                                 options);
      else if (given.count("check") > 0)
        check_simulations(file, MPI_COMM_WORLD, options, value("draw"));
      else
        run_simulations(file, MPI_COMM_WORLD, options);
    }



    std::string
    history_names()
    {
      std::map<std::string, std::string> laws;
      for (const std::string &law :
           dealii::Utilities::split_string_list(material_names(), '|'))
        for (const std::string &name : make_material(law, "")->state_names())
          laws[name] += (laws[name].empty() ? "" : ", ") + law;
      std::string result;
      for (const auto &[name, of] : laws)
        result += (result.empty() ? "" : "|") + name + " (" + of + ")";
      return result;
    }
  } // namespace



  Program
  simulation_program()
  {
    Program program;
    program.name = "greville";
    program.purpose =
      "runs simulations of parameter files by the material point method with "
      "B-splines";
    program.options = {
      {"check",
       "",
       "print sizes, step, time and memory without a run or results; takes "
       "several files",
       true,
       false,
       {},
       true},
      {"draw",
       "FOLDER",
       "with --check: write the initial points to a new folder"},
      {"resume",
       "",
       "resume the run from its last checkpoint; FILE.prm may be the folder of "
       "the run"},
      {"from",
       "FOLDER",
       "begin with the bodies at the last checkpoint of another run"},
      {"runs",
       "FOLDER",
       "for scripts/sweep: check the files of its runs in this folder, and "
       "move or remove earlier results"},
      {"element-test",
       "TEST",
       "run a laboratory test of a material instead of a simulation"},
      {"material",
       "NAME",
       "with --element-test: the material, if the file has several"}};
    program.run            = run_or_check;
    program.all_parameters = SimulationParameters::all;
    program.reference      = SimulationParameters::use_reference;
    program.examples       = simulation_examples();
    program.lists          = {{"materials", "Material NAME/Model", {}},
                              {"shapes", "", shape_names},
                              {"placements", "Body NAME/Placement", {}},
                              {"integrators", "Scheme/Stress update", {}},
                              {"formulations", "Scheme/Formulation", {}},
                              {"masses", "", mass_names},
                              {"solvers", "Solver/Method", {}},
                              {"implicit-solvers", "Implicit solver/Method", {}},
                              {"smoothers", "", smoother_names},
                              {"transfers", "Scheme/Transfer", {}},
                              {"walls", "Walls/Left", {}},
                              {"surface-loads", "Surface load NAME/Kind", {}},
                              {"fields", "Output/Fields", {}},
                              {"element-tests", "", element_test_names},
                              {"history", "", history_names},
                              {"columns", "", []() {
                        return boost::algorithm::join(Statistics<2>::names(),
                                                      "|");
                      }}};
    program.templates      = simulation_templates();
    return program;
  }
} // namespace greville

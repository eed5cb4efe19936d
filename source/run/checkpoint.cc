// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/run/checkpoint.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <filesystem>
#include <regex>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Increase the number if the meaning of texts or tables changes.
    constexpr const char *format = "Greville checkpoint 3";

    constexpr const char *prefix = "checkpoint_";

    constexpr unsigned int n_generations = 2;



    /// Return the checkpoints of a folder, the newest first. Copies under other
    /// names are ignored.
    std::vector<std::string>
    checkpoints_in(const std::string &folder)
    {
      static const std::regex  names(std::string(prefix) + R"([0-9]{10}\.h5)");
      std::vector<std::string> files;
      std::error_code          error;
      for (const auto &entry :
           std::filesystem::directory_iterator(folder, error))
        if (std::regex_match(entry.path().filename().string(), names))
          files.push_back(entry.path().string());
      std::sort(files.rbegin(), files.rend());
      return files;
    }



    /// Return the values of all parameters by "Section/Parameter" from a text
    /// of ParameterHandler.
    std::map<std::string, std::string>
    values_of(const std::string &text)
    {
      std::map<std::string, std::string> values;
      for (const ParameterLine &line : parameter_lines_of(text, "parameters"))
        if (!line.name.empty())
          values[(line.section.empty() ? "" : line.section + "/") + line.name] =
            line.value;
      return values;
    }



    bool
    may_change(const std::string &parameter)
    {
      for (const std::string section :
           {"Output/", "Checkpoints/", "Load balance/"})
        if (parameter.rfind(section, 0) == 0)
          return parameter != "Output/Probes";
      for (const std::string name :
           {"End", "Maximum steps", "Largest displacement", "End when"})
        if (boost::algorithm::ends_with(parameter, "Time/" + name))
          return true;
      return false;
    }
  } // namespace



  std::string
  describe_changes(const std::string &before, const std::string &now)
  {
    const auto  old_values = values_of(before), new_values = values_of(now);
    std::string changes;
    const auto  add = [&](const std::string &parameter,
                         const std::string &old_value,
                         const std::string &new_value) {
      if (!may_change(parameter) && old_value != new_value)
        changes += "\n  '" + parameter + "': " + old_value + " there, " +
                   new_value + " here";
    };
    for (const auto &[parameter, value] : old_values)
      {
        const auto found = new_values.find(parameter);
        add(parameter,
            value,
            found == new_values.end() ? "(none)" : found->second);
      }
    for (const auto &[parameter, value] : new_values)
      if (old_values.count(parameter) == 0)
        add(parameter, "(none)", value);
    return changes;
  }



  void
  check_points_fit(const std::string &before, const std::string &now)
  {
    const auto there = values_of(before), here = values_of(now);
    for (const std::string parameter :
         {"Simulation/Dimension", "Grid/Geometry"})
      {
        const auto value = there.find(parameter);
        Require(value == there.end() || value->second == here.at(parameter),
                "the parameter '" + parameter + "' is <" + value->second +
                  "> there and <" + here.at(parameter) +
                  "> here, so that its points carry different data");
      }
    const auto is_wet = there.find("Simulation/Pore water");
    Require(is_wet == there.end() || is_wet->second == "true" ||
              here.at("Water/Table").empty(),
            "the parameter 'Water/Table' is <" + here.at("Water/Table") +
              ">, but 'Simulation/Pore water' is false there: its stresses "
              "include no water table. Leave the table out; the pore pressure "
              "then begins with 0");
  }



  std::string
  write_checkpoint(const std::string &folder,
                   const unsigned int n_steps,
                   TablesFile         content,
                   const MPI_Comm     comm)
  {
    content.texts["format"]  = format;
    content.texts["version"] = GREVILLE_VERSION;
    const std::string file =
      folder + "/" + prefix + Utilities::int_to_string(n_steps, 10) + ".h5";
    write_tables(file, content, comm);
    run_on_first(comm, [&]() {
      const auto files = checkpoints_in(folder);
      for (unsigned int k = 0, n_older = 0; k < files.size(); ++k)
        // Newer checkpoints are from an abandoned run.
        if (files[k] > file || (files[k] < file && ++n_older >= n_generations))
          std::filesystem::remove(files[k]);
    });
    return file;
  }



  void
  check_folder_of_checkpoints(const std::string &folder, const MPI_Comm comm)
  {
    run_on_first(comm, [&]() {
      std::error_code error;
      Require(std::filesystem::exists(folder, error),
              "There is no folder <" + folder +
                ">, and no checkpoint to resume from.");
      Require(std::filesystem::is_directory(folder, error),
              "<" + folder +
                "> is a file, not the folder of a run with its checkpoints.");
    });
  }



  Checkpoint
  read_checkpoint(const std::string &folder, const MPI_Comm comm)
  {
    check_folder_of_checkpoints(folder, comm);
    // The first process looks for them.
    std::string list;
    if (Utilities::MPI::this_mpi_process(comm) == 0)
      for (const std::string &file : checkpoints_in(folder))
        list += file + "\n";
    std::istringstream files(Utilities::MPI::broadcast(comm, list));
    Checkpoint         checkpoint;
    while (std::getline(files, checkpoint.file))
      try
        {
          checkpoint.content       = read_tables(checkpoint.file, comm);
          const std::string &other = checkpoint.content.text("format");
          Require(other == format,
                  "Cannot read <" + checkpoint.file + ">: it has the format <" +
                    other + ">, and this version of the program reads <" +
                    format + ">.");
          return checkpoint;
        }
      catch (const std::exception &error)
        {
          checkpoint.refused.emplace_back(checkpoint.file, message_of(error));
        }
    std::string reasons;
    for (const auto &[file, reason] : checkpoint.refused)
      reasons += " " + reason;
    Require(false,
            "There is no checkpoint in the folder <" + folder +
              "> to resume from." + reasons);
    return checkpoint;
  }
} // namespace greville

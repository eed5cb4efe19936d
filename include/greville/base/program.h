// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/parameters.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace greville
{
  /// An option of a program: "--NAME", "--NAME VALUE", or both if the value is
  /// optional.
  struct ProgramOption
  {
    std::string name;
    /// The name of the value, "FOLDER"; empty if there is none.
    std::string value;
    std::string meaning;
    bool        value_is_needed = true;
    bool        may_be_repeated = false;
    /// The allowed values; empty if all are allowed. The word after an option
    /// is its optional value only if it is one of these.
    std::vector<std::string> words = {};
    /// True if runs with this option take several files, one after the other.
    bool takes_several_files = false;
  };



  /// The options given on a command line, with their values in the order of the
  /// command line.
  using GivenOptions = std::map<std::string, std::vector<std::string>>;



  /// A list shown by "--list NAME".
  struct ProgramList
  {
    std::string name;
    /// A parameter "Section/Parameter" whose allowed words are listed.
    std::string parameter;
    /// A function that returns the words, separated by '|', if they are not the
    /// allowed words of a parameter.
    std::function<std::string()> words;
  };



  /// A commented parameter file as a starting point.
  struct ProgramTemplate
  {
    std::string name, content;

    /// Return the first sentence of the comment at the top.
    std::string
    title() const;
  };



  struct Program
  {
    std::string name;
    /// A one-line description.
    std::string purpose;
    /// The options of runs, besides --set.
    std::vector<ProgramOption> options;
    /// Collective. Run a parameter file.
    std::function<void(const std::string &file, const GivenOptions &given)> run;
    /// Return the text of a parameter file in a style of ParameterHandler, with
    /// all parameters, their values and meanings: the values that result from a
    /// file, or the defaults for an empty name.
    std::function<
      std::string(const std::string                          &file,
                  const std::vector<std::string>             &settings,
                  const dealii::ParameterHandler::OutputStyle style)>
      all_parameters;
    /// Call a function with the reference of all parameters.
    std::function<void(const UseParameters &use)> reference;
    /// The text of parameter files whose sections the reference shows as
    /// examples.
    std::string                  examples;
    std::vector<ProgramList>     lists;
    std::vector<ProgramTemplate> templates;
  };

  /**
   * Collective. Read a command line and act. See doc/user/command_line.md for
   * the options. The options that runs receive include --set.
   *
   * Returns the exit status: 0, or 1 after an error, whose message is written
   * to stderr once. If all processes have detected an error, they return
   * together; if some still wait for others, all are aborted after two seconds.
   */
  int
  run_command_line(const Program                  &program,
                   const std::vector<std::string> &arguments);

  /// Run the main() of a program: initialize MPI, and call run_command_line().
  int
  run_program(const Program &program, int argc, char **argv);
} // namespace greville

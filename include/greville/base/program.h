// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_program_h
#define greville_base_program_h

#include <greville/base/parameters.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace greville
{
  /**
   * An option of a program: "--NAME", "--NAME VALUE", or both where the value
   * may be left out.
   */
  struct ProgramOption
  {
    std::string name;
    /// What the value is, "FOLDER"; empty where there is none.
    std::string value;
    std::string meaning;
    bool        value_is_needed = true;
    bool        may_be_repeated = false;
    /// What the value may be; empty: what it likes. One that is not needed is
    /// what follows the option only where it is one of these.
    std::vector<std::string> words = {};
    /// True if runs with this option take several files, one after the other.
    bool takes_several_files = false;
  };



  /**
   * The options that a command line has given, with their values in the order
   * of the command line.
   */
  using GivenOptions = std::map<std::string, std::vector<std::string>>;



  /**
   * What "--list NAME" shows.
   */
  struct ProgramList
  {
    std::string name;
    /// "Section/Parameter": the words that are allowed there.
    std::string parameter;
    /// Where no parameter has them as its words: they, separated by '|'.
    std::function<std::string()> words;
  };



  /**
   * A commented parameter file to begin with.
   */
  struct ProgramTemplate
  {
    std::string name, content;

    /**
     * The first sentence of the comment at the top.
     */
    std::string
    title() const;
  };



  /**
   * What a program is called and does.
   */
  struct Program
  {
    std::string name;
    /// What it is, in one line.
    std::string purpose;
    /// Those of runs, besides --set.
    std::vector<ProgramOption> options;
    /// Run a parameter file. Collective.
    std::function<void(const std::string &file, const GivenOptions &given)> run;
    /// The text of a parameter file with all parameters, their values and
    /// meanings: those that a file leads to, or the defaults for an empty name.
    std::function<std::string(const std::string              &file,
                              const std::vector<std::string> &settings)>
      all_parameters;
    /// Call a function with the reference of all parameters.
    std::function<void(const UseParameters &use)> reference;
    /// The text of parameter files, of which the reference shows sections.
    std::string                  examples;
    std::vector<ProgramList>     lists;
    std::vector<ProgramTemplate> templates;
  };

  /**
   * Collective. Read a command line and act. doc/user/command_line.md has the
   * options; --set is one of those that runs are given.
   *
   * Returns the exit status: 0, or 1 after an error, whose message goes to
   * stderr once. Where all processes have found an error they return together;
   * where some of them still wait for others, all are aborted after two
   * seconds.
   */
  int
  run_command_line(const Program                  &program,
                   const std::vector<std::string> &arguments);

  /**
   * The main() of a program: initialize MPI, and run_command_line().
   */
  int
  run_program(const Program &program, int argc, char **argv);
} // namespace greville

#endif

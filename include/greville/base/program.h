// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_program_h
#define greville_base_program_h

#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace greville
{
  /**
   * An option of a program for its runs: "--NAME", or "--NAME VALUE".
   */
  struct ProgramOption
  {
    std::string name;
    /// What the value is, "FOLDER"; empty where there is none.
    std::string value;
    std::string meaning;
  };



  /**
   * The options that a command line has given, with their values.
   */
  using GivenOptions = std::map<std::string, std::string>;



  /**
   * What a program is called and does.
   */
  struct Program
  {
    std::string name;
    /// What it is, in one line.
    std::string                purpose;
    std::vector<ProgramOption> options;
    /// Run a parameter file. Collective.
    std::function<void(const std::string &file, const GivenOptions &given)> run;
    /// Print the reference of all parameters.
    std::function<void(std::ostream &)> print_parameters;
  };

  /**
   * The main() of a program: initialize MPI, read the command line, and run.
   *
   *   NAME FILE.prm [...]  run a parameter file, with options of its own
   *   NAME --parameters    print the reference of all parameters
   *   NAME --help, -h      print how to call the program
   *   NAME --version       print its version and that of deal.II
   *
   * Returns the exit status: 0, or 1 after an error, whose message goes to
   * stderr once. Where all processes have found an error they end together;
   * where some of them still wait for others, all are aborted after two
   * seconds.
   */
  int
  run_program(const Program &program, int argc, char **argv);
} // namespace greville

#endif

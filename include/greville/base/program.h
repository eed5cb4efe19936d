// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_program_h
#define greville_base_program_h

#include <functional>
#include <ostream>
#include <string>

namespace greville
{
  /**
   * What a program is called and does.
   */
  struct Program
  {
    std::string name;
    /// What it is, in one line.
    std::string purpose;
    /// Run a parameter file. Collective.
    std::function<void(const std::string &file)> run;
    /// Print the reference of all parameters.
    std::function<void(std::ostream &)> print_parameters;
  };

  /**
   * The main() of a program: initialize MPI, read the command line, and run.
   *
   *   NAME FILE.prm        run a parameter file
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

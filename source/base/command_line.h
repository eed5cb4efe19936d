// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_source_base_command_line_h
#define greville_source_base_command_line_h

#include <greville/base/program.h>

#include <stdexcept>

namespace greville
{
  namespace internal
  {
    /**
     * The option that sets a parameter.
     */
    extern const ProgramOption set_option;

    /**
     * All options of a program, first those of runs.
     */
    std::vector<ProgramOption>
    options_of(const Program &program);

    /**
     * The text of --help.
     */
    std::string
    usage_of(const Program &program);

    /**
     * A wrong command line; the message is followed by a hint to --help.
     */
    class CommandLineError : public std::runtime_error
    {
    public:
      using std::runtime_error::runtime_error;
    };

    /**
     * Files, and options with their values.
     */
    struct CommandLine
    {
      /**
       * Throws a CommandLineError where the command line is wrong.
       */
      CommandLine(const Program                  &program,
                  const std::vector<std::string> &arguments);

      /**
       * The value of the option that says what to do, or nothing.
       */
      std::string
      value_of_action() const;

      std::vector<std::string> files;
      GivenOptions             given;
      /// The option that says what to do, or empty for a run.
      std::string act;
    };
  } // namespace internal
} // namespace greville

#endif

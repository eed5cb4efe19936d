// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/program.h>

#include <stdexcept>

namespace greville::internal
{
  extern const ProgramOption set_option;

  /// Return all options of a program, options of runs first.
  std::vector<ProgramOption>
  options_of(const Program &program);

  /// Return the text of --help.
  std::string
  usage_of(const Program &program);

  /// An invalid command line; the message is followed by a hint to --help.
  class CommandLineError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /// A parsed command line: files, and options with their values.
  struct CommandLine
  {
    /// Throws a CommandLineError if the command line is invalid.
    CommandLine(const Program                  &program,
                const std::vector<std::string> &arguments);

    /// Return the value of the option that selects the action, or an empty
    /// text.
    std::string
    value_of_action() const;

    std::vector<std::string> files;
    GivenOptions             given;
    /// The option that selects the action, or empty for a run.
    std::string act;
  };
} // namespace greville::internal

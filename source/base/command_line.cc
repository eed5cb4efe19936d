// SPDX-License-Identifier: LGPL-2.1-or-later

#include "command_line.h"

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Options for actions other than a run.
    const std::vector<ProgramOption> actions = {
      {"new",
       "TEMPLATE",
       "write a commented parameter file, TEMPLATE.prm or FILE.prm; without "
       "TEMPLATE, list the templates",
       false},
      {"list",
       "NAME",
       "print the list NAME, such as materials, the parameters of the section "
       "NAME, or the description of a parameter, SECTION/PARAMETER; without "
       "NAME, print the names of all lists",
       false},
      {"print-parameters",
       "FORMAT",
       "print all parameters as a parameter file, with the values of FILE.prm "
       "or the defaults; FORMAT is prm, json, or xml for deal.II's parameter "
       "GUI",
       false,
       false,
       {"prm", "json", "xml"}},
      {"parameters", "", "print the reference of all parameters in Markdown"},
      {"completion",
       "SHELL",
       "print a script with which the shell (bash) completes these options"},
      {"help", "", "print this (also -h)"},
      {"version", "", "print the version"}};



    bool
    has_action(const Program &program, const ProgramOption &action)
    {
      return action.name != "new" || !program.templates.empty();
    }



    /// Return a text in lines of at most 79 letters, of which all but the first
    /// are indented.
    std::string
    wrapped(const std::string &text, const unsigned int indent)
    {
      std::string result;
      for (const std::string &line :
           Utilities::break_text_into_lines(text, 79 - indent))
        result +=
          (result.empty() ? "" : "\n" + std::string(indent, ' ')) + line;
      return result + "\n";
    }
  } // namespace



  namespace internal
  {
    const ProgramOption set_option = {
      "set",
      "\"SECTION/PARAMETER=VALUE\"",
      "replace the value of a parameter; may be repeated",
      true,
      true};



    std::vector<ProgramOption>
    options_of(const Program &program)
    {
      std::vector<ProgramOption> options = {set_option};
      options.insert(options.end(),
                     program.options.begin(),
                     program.options.end());
      for (const ProgramOption &action : actions)
        if (has_action(program, action))
          options.push_back(action);
      return options;
    }



    std::string
    usage_of(const Program &program)
    {
      constexpr unsigned int indent = 22;
      std::string            result =
        wrapped(program.name + ": " + program.purpose + ".", 0) +
        "\nUsage: " + program.name +
        " FILE.prm [OPTION...]    run a parameter file\n       " +
        program.name + " OPTION                   print information\n\n" +
        "Options of runs:\n";
      const auto add = [&](const ProgramOption &option) {
        std::string words = "  --" + option.name;
        if (!option.value.empty())
          words += option.value_is_needed ? " " + option.value
                                          : " [" + option.value + "]";
        // The meaning is beside the option, or below a long option.
        words += words.size() + 2 > indent
                   ? "\n" + std::string(indent, ' ')
                   : std::string(indent - words.size(), ' ');
        result += words + wrapped(option.meaning, indent);
      };
      add(set_option);
      for (const ProgramOption &option : program.options)
        add(option);
      result += "Other options:\n";
      for (const ProgramOption &action : actions)
        if (has_action(program, action))
          add(action);
      return result;
    }



    CommandLine::CommandLine(const Program                  &program,
                             const std::vector<std::string> &arguments)
    {
      const auto               options = options_of(program);
      std::vector<std::string> known;
      for (const ProgramOption &option : options)
        known.push_back("--" + option.name);
      const auto is_option = [](const std::string &argument) {
        return argument.size() > 1 && argument[0] == '-';
      };
      for (std::size_t k = 0; k < arguments.size(); ++k)
        {
          std::string argument = arguments[k] == "-h" ? "--help" : arguments[k];
          if (!is_option(argument))
            {
              files.push_back(argument);
              continue;
            }
          std::vector<std::string> values;
          const auto               equal = argument.find('=');
          if (equal != std::string::npos)
            {
              values.push_back(argument.substr(equal + 1));
              argument = argument.substr(0, equal);
            }
          const auto found =
            std::find(known.begin(), known.end(), argument) - known.begin();
          if (found == std::ptrdiff_t(known.size()))
            throw CommandLineError("there is no option <" + argument + ">." +
                                   did_you_mean(argument, known));
          const ProgramOption &option = options[found];
          if (option.value.empty() && !values.empty())
            throw CommandLineError("the option <" + argument +
                                   "> takes no value.");
          const auto is_word = [&](const std::string &word) {
            return option.words.empty() || contains(option.words, word);
          };
          if (!option.value.empty() && values.empty() &&
              k + 1 < arguments.size() &&
              (option.value_is_needed ||
               (!is_option(arguments[k + 1]) && is_word(arguments[k + 1]))))
            values.push_back(arguments[++k]);
          if (!values.empty() && !is_word(values[0]))
            throw CommandLineError(
              "the option <" + argument + "> takes one of " +
              boost::algorithm::join(option.words, "|") + ", not <" +
              values[0] + ">." + did_you_mean(values[0], option.words));
          if (option.value_is_needed && !option.value.empty() && values.empty())
            throw CommandLineError("the option <" + argument +
                                   "> needs a value: " + option.value + ".");
          if (given.count(option.name) > 0 && !option.may_be_repeated)
            throw CommandLineError("the option <" + argument +
                                   "> is given twice.");
          auto &all = given[option.name];
          all.insert(all.end(), values.begin(), values.end());
        }
      for (const ProgramOption &action : actions)
        if (given.count(action.name) > 0)
          {
            if (!act.empty() && act != "help" && action.name != "help")
              throw CommandLineError("--" + act + " and --" + action.name +
                                     " exclude each other.");
            act = action.name;
            if (act == "help")
              break;
          }
    }



    std::string
    CommandLine::value_of_action() const
    {
      const auto &values = given.at(act);
      return values.empty() ? "" : values[0];
    }
  } // namespace internal
} // namespace greville

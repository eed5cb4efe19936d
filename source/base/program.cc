// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/foreign_call.h>
#include <greville/base/memory.h>
#include <greville/base/parameter_tree.h>
#include <greville/base/plugin.h>

#include "command_line.h"
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>
#include <set>
#include <sstream>
#include <string_view>
#include <thread>
#include <vector>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    static_assert(std::string_view(GREVILLE_VERSION) == GREVILLE_PLUGIN_VERSION,
                  "Let plugin.h have the version of CMakeLists.txt.");

    std::string
    version_of(const Program &program)
    {
      return program.name + " " + GREVILLE_VERSION + ", deal.II " +
             DEAL_II_PACKAGE_VERSION + "\n";
    }



    /// Return whether all other processes reach a barrier within some seconds.
    bool
    all_arrive(MPI_Request &barrier)
    {
      const auto end =
        std::chrono::steady_clock::now() + std::chrono::seconds(2);
      int have_arrived = 0;
      while (!have_arrived && std::chrono::steady_clock::now() < end)
        {
          MPI_Test(&barrier, &have_arrived, MPI_STATUS_IGNORE);
          if (!have_arrived)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
      return have_arrived;
    }



    void
    report(const Program &program, const std::string &message)
    {
      // A library may have changed this setting.
      std::cerr.exceptions(std::ios::goodbit);
      std::cerr.clear();
      std::cerr << program.name << ": " << message << std::endl;
    }



    /// Collective. Report the messages of all processes, each once, and return
    /// whether there is one. If a process has a message and others do not
    /// arrive within two seconds, they are waiting for it forever: all are
    /// aborted.
    bool
    report_messages(const Program     &program,
                    const std::string &message,
                    const MPI_Comm     comm)
    {
      const unsigned int process = Utilities::MPI::this_mpi_process(comm);
      MPI_Request        barrier;
      MPI_Ibarrier(comm, &barrier);
      if (message.empty())
        MPI_Wait(&barrier, MPI_STATUS_IGNORE);
      else if (!all_arrive(barrier))
        {
          // The first process that arrives reports the messages.
          std::this_thread::sleep_for(
            std::chrono::milliseconds(500 * std::min(process, 4u)));
          report(program, message);
          ExitGuard::release();
          MPI_Abort(MPI_COMM_WORLD, 1);
        }
      std::set<std::string> messages;
      for (const std::string &other : Utilities::MPI::all_gather(comm, message))
        if (!other.empty() && messages.insert(other).second && process == 0)
          report(program, other);
      return !messages.empty();
    }



    /// Return the name of a user's library that may have thrown an exception.
    std::string
    of_library()
    {
      const std::string file = ForeignCall::library();
      return file.empty() ? ""
                          : " (The program has loaded the library <" + file +
                              ">, which may have thrown this.)";
    }



    /// Return the message of the exception of @p action, or an empty text.
    std::string
    message_of_action(const Program               &program,
                      const std::function<void()> &action)
    {
      try
        {
          action();
        }
      catch (const CommandLineError &error)
        {
          return std::string(error.what()) + " See " + program.name +
                 " --help.";
        }
      catch (const std::bad_alloc &)
        {
          return "There is not enough memory: take fewer cells or points.";
        }
      catch (const ExceptionBase &error)
        {
          return message_of(error);
        }
      catch (const std::exception &error)
        {
          return message_of(error) + of_library();
        }
      catch (...)
        {
          return "An exception without a message has been thrown." +
                 of_library();
        }
      return "";
    }



    std::vector<std::string>
    words_of(const Program &program, const ProgramList &list)
    {
      std::vector<std::string> words;
      if (list.words)
        return Utilities::split_string_list(list.words(), '|');
      program.reference([&](const ParameterHandler &prm) {
        words = words_of_parameter(prm, list.parameter);
      });
      return words;
    }



    void
    print_list(std::ostream      &out,
               const Program     &program,
               const std::string &what)
    {
      std::vector<std::string> names;
      for (const ProgramList &list : program.lists)
        {
          names.push_back(list.name);
          const bool is_it = list.name == what;
          if (what.empty())
            out << list.name << '\n';
          for (const std::string &word :
               is_it ? words_of(program, list) : std::vector<std::string>())
            out << word << '\n';
          if (is_it)
            return;
        }
      if (what.empty())
        return;
      const std::string hint = did_you_mean(what, names);
      if (!hint.empty() && what.find('/') == std::string::npos)
        throw CommandLineError("there is no list <" + what + ">." + hint);
      program.reference([&](const ParameterHandler &prm) {
        describe_parameter(out, prm, what);
      });
    }



    void
    print_parameters(std::ostream                   &out,
                     const Program                  &program,
                     const std::string              &format,
                     const std::string              &file,
                     const std::vector<std::string> &settings)
    {
      const std::string text =
        program.all_parameters(file,
                               settings,
                               format == "xml" ? ParameterHandler::XML
                                               : ParameterHandler::PRM);
      if (format == "json")
        write_as_json(out, text);
      else
        out << text;
    }



    /// Print a script that lets bash complete options, their values if known,
    /// and files.
    void
    print_completion(std::ostream      &out,
                     const Program     &program,
                     const std::string &shell)
    {
      if (shell != "bash")
        throw CommandLineError("--completion supports only the shell bash, "
                               "not <" +
                               shell + ">.");
      std::string options, lists, templates;
      for (const ProgramOption &option : options_of(program))
        options += " --" + option.name;
      for (const ProgramList &list : program.lists)
        lists += " " + list.name;
      for (const ProgramTemplate &one : program.templates)
        templates += " " + one.name;
      const std::string function = "_" + program.name;
      out << "# Completion of " << program.name
          << " for bash, made by: " << program.name << " --completion bash\n"
          << function << "()\n{\n"
          << "  local word=${COMP_WORDS[COMP_CWORD]}"
          << " before=${COMP_WORDS[COMP_CWORD-1]}\n"
          << "  case $before in\n"
          << "    --list) COMPREPLY=($(compgen -W '" << lists
          << "' -- \"$word\"));;\n"
          << "    --new) COMPREPLY=($(compgen -W '" << templates
          << "' -- \"$word\"));;\n"
          << "    --completion) COMPREPLY=(bash);;\n"
          << "    --print-parameters) COMPREPLY=($(compgen -W 'prm json xml' "
          << "-- \"$word\"; compgen -f -X '!*.prm' -- \"$word\"));;\n"
          << "    --set) COMPREPLY=();;\n";
      for (const ProgramOption &option : program.options)
        if (option.value == "FOLDER")
          out << "    --" << option.name
              << ") COMPREPLY=($(compgen -d -- \"$word\"));;\n";
      out << "    *)\n      case $word in\n"
          << "        -*) COMPREPLY=($(compgen -W '" << options
          << "' -- \"$word\"));;\n"
          << "        *) COMPREPLY=($(compgen -f -X '!*.prm' -- \"$word\";"
          << " compgen -d -- \"$word\"));;\n"
          << "      esac;;\n  esac\n}\n"
          << "complete -o filenames -F " << function << ' ' << program.name
          << '\n';
    }



    /// Write a template, without overwriting files.
    void
    write_template(std::ostream                   &out,
                   const Program                  &program,
                   const std::string              &name,
                   const std::vector<std::string> &files)
    {
      std::vector<std::string> names;
      for (const ProgramTemplate &one : program.templates)
        names.push_back(one.name);
      if (name.empty())
        {
          for (const ProgramTemplate &one : program.templates)
            out << one.name << std::string(22 - one.name.size(), ' ')
                << one.title() << '\n';
          return;
        }
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        throw CommandLineError("there is no template <" + name +
                               ">; --new alone lists them." +
                               did_you_mean(name, names));
      const std::string file = files.empty() ? name + ".prm" : files[0];
      run_on_first(MPI_COMM_WORLD, [&]() {
        errno                = 0;
        std::FILE *const own = std::fopen(file.c_str(), "wx");
        Require(own != nullptr || errno != EEXIST,
                "There is a file <" + file +
                  "> already: name another one, as in --new " + name +
                  " FILE.prm.");
        Require(own != nullptr, write_error(file));
        const std::string &content =
          program.templates[found - names.begin()].content;
        const bool is_written =
          std::fwrite(content.data(), 1, content.size(), own) == content.size();
        Require((std::fclose(own) == 0) && is_written, write_error(file));
      });
      out << "Written: " << file << "\nRun it: " << program.name << ' ' << file
          << '\n';
    }



    void
    check_several_files(const Program &program, const CommandLine &line)
    {
      const std::string n = std::to_string(line.files.size());
      std::string       hint;
      bool              takes_several = false;
      for (const ProgramOption &option : program.options)
        if (option.takes_several_files)
          {
            hint += "; --" + option.name + " takes several";
            takes_several = takes_several || line.given.count(option.name) > 0;
          }
      if (!takes_several || !line.act.empty())
        throw CommandLineError("takes one parameter file, not " + n + hint +
                               ".");
      for (const ProgramOption &option : program.options)
        if (line.given.count(option.name) > 0 && !option.takes_several_files)
          throw CommandLineError("--" + option.name +
                                 " takes one parameter file, not " + n + ".");
    }



    /// Collective. Run each file, even if earlier ones have failed, and report
    /// their messages. Returns whether all have succeeded.
    bool
    run_files(const Program     &program,
              const CommandLine &line,
              std::ostream      &out,
              const MPI_Comm     comm)
    {
      unsigned int n_refused = 0;
      for (const std::string &file : line.files)
        {
          std::string message = message_of_action(program, [&]() {
            program.run(file, line.given);
          });
          if (!message.empty())
            message = file + ": " + message;
          out << std::endl;
          if (report_messages(program, message, comm))
            ++n_refused;
        }
      out << line.files.size() << " files, " << n_refused << " refused\n";
      return n_refused == 0;
    }



    /// Execute the command line, and return whether this has succeeded. Throws
    /// if it is invalid.
    bool
    act(const Program                  &program,
        const std::vector<std::string> &arguments,
        const MPI_Comm                  comm)
    {
      const bool         is_first = Utilities::MPI::this_mpi_process(comm) == 0;
      std::ostream       nowhere(nullptr);
      std::ostream      &out = is_first ? std::cout : nowhere;
      const CommandLine  line(program, arguments);
      const auto        &files    = line.files;
      const std::string &action   = line.act;
      const auto         settings = line.given.find(set_option.name);
      const bool         takes_file =
        action.empty() || action == "print-parameters" || action == "new";
      if (files.size() > 1 && action != "help")
        check_several_files(program, line);
      if (!takes_file && !files.empty() && action != "help")
        throw CommandLineError("--" + action +
                               " takes no file, but the "
                               "command line has <" +
                               files[0] + ">?");
      for (const auto &option : line.given)
        if (option.first != action && action != "help" && !action.empty() &&
            (option.first != set_option.name || action != "print-parameters" ||
             files.empty()))
          throw CommandLineError("--" + option.first +
                                 " is for a parameter file that is " +
                                 (action == "print-parameters"
                                    ? "printed or run."
                                    : "run, and --" + action + " runs none."));
      bool has_worked = true;
      if (action == "help")
        out << usage_of(program);
      else if (action == "version")
        out << version_of(program);
      else if (action == "parameters")
        {
          if (is_first)
            program.reference([&](const ParameterHandler &prm) {
              print_parameter_reference(out,
                                        program.name,
                                        prm,
                                        program.examples);
            });
        }
      else if (action == "list")
        print_list(out, program, line.value_of_action());
      else if (action == "completion")
        print_completion(out, program, line.value_of_action());
      else if (action == "new")
        write_template(out, program, line.value_of_action(), files);
      else if (action == "print-parameters")
        print_parameters(out,
                         program,
                         line.value_of_action(),
                         files.empty() ? "" : files[0],
                         settings == line.given.end()
                           ? std::vector<std::string>()
                           : settings->second);
      else if (files.empty())
        throw CommandLineError("there is no parameter file to run.");
      else if (files.size() > 1)
        has_worked = run_files(program, line, out, comm);
      else
        program.run(files[0], line.given);
      out.flush();
      return has_worked;
    }
  } // namespace



  std::string
  ProgramTemplate::title() const
  {
    std::istringstream lines(content);
    std::string        title;
    for (std::string line; std::getline(lines, line) && line[0] == '#';)
      {
        title += (title.empty() ? "" : " ") + Utilities::trim(line.substr(1));
        const auto end = (title + " ").find(". ");
        if (end != std::string::npos)
          return title.substr(0, end);
      }
    return title;
  }



  int
  run_command_line(const Program                  &program,
                   const std::vector<std::string> &arguments)
  {
    // A separate communicator: messages of the run cannot be confused with
    // these.
    MPI_Comm comm;
    MPI_Comm_dup(MPI_COMM_WORLD, &comm);
    bool              has_worked = true;
    const std::string message    = message_of_action(program, [&]() {
      has_worked = act(program, arguments, comm);
    });
    if (report_messages(program, message, comm))
      has_worked = false;
    MPI_Comm_free(&comm);
    return has_worked ? 0 : 1;
  }



  int
  run_program(const Program &program, int argc, char **argv)
  {
    const std::vector<std::string> arguments(argv + std::min(argc, 1),
                                             argv + argc);
    // A file that is too large then gives an error with a message.
    std::signal(SIGXFSZ, SIG_IGN);
    return_free_memory();
    // PETSc would interpret options of this program as its own, and print
    // warnings about them to standard output. Options of PETSc can be set in
    // PETSC_OPTIONS.
    int                              n_for_petsc = std::min(argc, 1);
    Utilities::MPI::MPI_InitFinalize mpi(n_for_petsc, argv, 1);
    const ExitGuard                  guard;
    return run_command_line(program, arguments);
  }
} // namespace greville

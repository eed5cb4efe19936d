// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>
#include <greville/base/program.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace greville
{
  using namespace dealii;

  namespace
  {
    std::string
    usage_of(const Program &program)
    {
      const std::string &name = program.name;
      std::string        options;
      for (const ProgramOption &option : program.options)
        {
          const std::string words = "--" + option.name +
                                    (option.value.empty() ? "" : " ") +
                                    option.value;
          options +=
            "\n       " + name + " FILE.prm " + words +
            std::string(words.size() < 16 ? 16 - words.size() : 1, ' ') +
            option.meaning;
        }
      return "Usage: " + name + " FILE.prm        run a parameter file" +
             options + "\n       " + name +
             " --parameters    print all parameters as a page\n       " + name +
             " --help          print this (also -h)\n       " + name +
             " --version       print the version\n";
    }



    std::string
    version_of(const Program &program)
    {
      return program.name + " " + GREVILLE_VERSION + ", deal.II " +
             DEAL_II_PACKAGE_VERSION + "\n";
    }



    /**
     * How to call the program follows its message.
     */
    class CommandLineError : public std::runtime_error
    {
    public:
      using std::runtime_error::runtime_error;
    };



    /**
     * Whether all processes come here within some seconds.
     */
    bool
    all_arrive(const MPI_Comm comm)
    {
      MPI_Request request;
      MPI_Ibarrier(comm, &request);
      const auto end =
        std::chrono::steady_clock::now() + std::chrono::seconds(2);
      int have_arrived = 0;
      while (!have_arrived && std::chrono::steady_clock::now() < end)
        {
          MPI_Test(&request, &have_arrived, MPI_STATUS_IGNORE);
          if (!have_arrived)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
      return have_arrived;
    }



    void
    report(const Program &program, const std::string &message)
    {
      std::cerr << program.name << ": " << message << std::endl;
    }



    /**
     * The options, or a file to run. Throws where the command line is wrong.
     */
    void
    act(const Program                  &program,
        const std::vector<std::string> &arguments,
        const bool                      is_first)
    {
      std::ostream  nowhere(nullptr);
      std::ostream &out = is_first ? std::cout : nowhere;
      if (arguments.empty())
        throw CommandLineError("there is no parameter file to run.");
      std::vector<std::string> files;
      GivenOptions             given;
      for (std::size_t k = 0; k < arguments.size(); ++k)
        {
          const auto option =
            std::find_if(program.options.begin(),
                         program.options.end(),
                         [&](const ProgramOption &o) {
                           return arguments[k] == "--" + o.name;
                         });
          if (option == program.options.end())
            {
              files.push_back(arguments[k]);
              continue;
            }
          std::string &value = given[option->name];
          if (option->value.empty())
            continue;
          if (k + 1 == arguments.size())
            throw CommandLineError("the option <" + arguments[k] +
                                   "> needs a value: " + option->value + ".");
          value = arguments[++k];
        }
      if (files.empty())
        throw CommandLineError("there is no parameter file to run.");
      if (files.size() > 1)
        {
          for (const std::string &file : files)
            if (file[0] == '-')
              throw CommandLineError("there is no option <" + file + ">.");
          throw CommandLineError("takes one parameter file, not " +
                                 std::to_string(files.size()) + ".");
        }
      const std::string &argument = files[0];
      if (argument == "--help" || argument == "-h")
        out << program.name << ": " << program.purpose << "\n\n"
            << usage_of(program);
      else if (argument == "--version")
        out << version_of(program);
      else if (argument == "--parameters")
        {
          if (is_first)
            program.print_parameters(out);
        }
      else
        {
          if (!argument.empty() && argument[0] == '-')
            throw CommandLineError("there is no option <" + argument + ">.");
          program.run(argument, given);
        }
      out.flush();
    }
  } // namespace



  int
  run_program(const Program &program, int argc, char **argv)
  {
    const std::vector<std::string>   arguments(argv + std::min(argc, 1),
                                             argv + argc);
    Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
    // Of its own: no message of the run can be taken for one of these.
    MPI_Comm comm;
    MPI_Comm_dup(MPI_COMM_WORLD, &comm);
    const unsigned int process = Utilities::MPI::this_mpi_process(comm);
    std::string        message;
    try
      {
        act(program, arguments, process == 0);
      }
    catch (const CommandLineError &error)
      {
        message = std::string(error.what()) + "\n" + usage_of(program);
      }
    catch (const std::bad_alloc &)
      {
        message = "The memory is not enough: fewer cells or points need less.";
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }

    if (!message.empty())
      {
        if (!all_arrive(comm))
          {
            // Some process waits for others for ever. The first of those that
            // do not reports and ends the rest.
            std::this_thread::sleep_for(
              std::chrono::milliseconds(500 * std::min(process, 4u)));
            report(program, message);
            MPI_Abort(MPI_COMM_WORLD, 1);
          }
        const auto            all = Utilities::MPI::all_gather(comm, message);
        std::set<std::string> reported;
        for (const std::string &other : all)
          if (process == 0 && !other.empty() && reported.insert(other).second)
            report(program, other);
      }
    MPI_Comm_free(&comm);
    return message.empty() ? 0 : 1;
  }
} // namespace greville

// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

// Wrong parameter files are answered by one clear message, the same on all
// processes, and a run that breaks stops with step, time and point, and leaves
// its last good state. refusals.txt has the files and the messages.
#include <greville/run/run.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <tests.h>
#include <unistd.h>

namespace refusals
{
  // Seconds after which a case has failed: a process may wait for ever.
  constexpr unsigned int time_limit = 60;



  struct Case
  {
    std::string base, title, run = "case.prm", before, text, instead;
    std::vector<std::string>                         settings, files_left;
    std::vector<std::pair<std::string, std::string>> files, links;
    /// The whole message, and the one on two processes, if it differs.
    std::string message, message_of_two;
  };



  inline std::string
  replaced(std::string        text,
           const std::string &word,
           const std::string &replacement)
  {
    for (std::size_t k = 0; (k = text.find(word, k)) != std::string::npos;
         k += replacement.size())
      text.replace(k, word.size(), replacement);
    return text;
  }



  /// The text that a line stands for.
  inline std::string
  unescaped(const std::string &line)
  {
    const std::string text = replaced(line, "{source}", SOURCE_DIR "/../..");
    std::string       result;
    for (std::size_t k = 0; k < text.size(); ++k)
      if (text.compare(k, 2, "\\n") == 0)
        {
          result += '\n';
          ++k;
        }
      else if (text.compare(k, 2, "\\x") == 0)
        {
          result += char(std::stoi(text.substr(k + 2, 2), nullptr, 16));
          k += 3;
        }
      else
        result += text[k];
    return result;
  }



  /// "Stage one/Time/End = 2" as text of a parameter file.
  inline std::string
  parameter_text(const std::string &line)
  {
    const auto equal = line.find('=');
    AssertThrow(equal != std::string::npos && line.find('/') < equal,
                ExcMessage("<" + line + "> is no line of refusals.txt."));
    const std::vector<std::string> names =
      Utilities::split_string_list(line.substr(0, equal), '/');
    std::string begin, end;
    for (unsigned int k = 0; k + 1 < names.size(); ++k)
      {
        begin += "subsection " + names[k] + "\n";
        end += "end\n";
      }
    return begin + "set " + names.back() + " =" + line.substr(equal + 1) +
           "\n" + end;
  }



  /// Add an indented line to a case.
  inline void
  add_line(Case &c, const std::string &line)
  {
    const auto        space = line.find(' ');
    const std::string word  = line.substr(0, space);
    const std::string rest =
      space == std::string::npos ? "" : unescaped(line.substr(space + 1));
    const auto        gap  = rest.find(' ');
    const std::string name = rest.substr(0, gap);
    const std::string behind =
      gap == std::string::npos ? "" : rest.substr(gap + 1);
    if (word == ">")
      c.message = rest;
    else if (word == "2>")
      c.message_of_two = rest;
    else if (word == "--set")
      c.settings.push_back(rest);
    else if (word == "text")
      c.text += rest;
    else if (word == "before")
      c.before += rest;
    else if (word == "instead")
      c.instead += rest;
    else if (word == "run")
      c.run = rest;
    else if (word == "leaves")
      c.files_left.push_back(rest);
    else if (word == "file")
      c.files.emplace_back(name, behind);
    else if (word == "link")
      c.links.emplace_back(name, behind);
    else
      c.text += parameter_text(unescaped(line));
  }



  /// The texts of the bases by their names, and all cases.
  inline std::pair<std::map<std::string, std::string>, std::vector<Case>>
  read_table(const std::string &file)
  {
    std::map<std::string, std::string> bases;
    std::vector<Case>                  cases;
    Case                               base;
    bool                               is_base = false;
    std::ifstream                      in(file);
    for (std::string line; std::getline(in, line);)
      if (line.empty() || line[0] == '#')
        continue;
      else if (line[0] == ' ')
        {
          Case &c = is_base ? base : cases.back();
          add_line(c, line.substr(line.find_first_not_of(' ')));
          if (is_base)
            bases[base.base] = base.text;
        }
      else if (line.compare(0, 5, "base ") == 0)
        {
          const auto names = Utilities::split_string_list(line.substr(5), ' ');
          is_base          = true;
          base             = Case();
          base.base        = names[0];
          base.text        = names.size() == 3
                               ? bases.at(names[2])
                               : "subsection Output\nset Directory = results\n"
                                 "end\n";
          bases[base.base] = base.text;
        }
      else
        {
          is_base = false;
          cases.emplace_back();
          cases.back().base  = base.base;
          cases.back().title = line;
        }
    return {bases, cases};
  }



  /// Write the files of a case, and remove the results of others.
  inline void
  write_files(const Case &c)
  {
    for (const std::string folder : {"results", "full"})
      std::filesystem::remove_all(folder);
    std::filesystem::create_directory("full");
    for (const auto &[name, target] : c.links)
      {
        const std::filesystem::path path = name;
        if (path.has_parent_path())
          std::filesystem::create_directories(path.parent_path());
        std::filesystem::create_symlink(target, path);
      }
    for (const auto &[name, text] : c.files)
      {
        const auto folder = std::filesystem::path(name).parent_path();
        if (!folder.empty())
          std::filesystem::create_directories(folder);
        std::ofstream(name) << text;
      }
    std::ofstream("case.prm")
      << (c.instead.empty() ? c.before + "include " + c.base + ".prm\n" + c.text
                            : c.instead);
  }



  /// Return true if a message is the wanted one, in which "..." is any text.
  inline bool
  fits(const std::string &message, const std::string &wanted)
  {
    const std::string dots = "...";
    std::size_t       at = 0, begin = 0;
    for (bool is_first = true;; is_first = false)
      {
        const auto        end  = wanted.find(dots, begin);
        const std::string part = wanted.substr(begin, end - begin);
        if (end == std::string::npos)
          return message.size() >= at + part.size() &&
                 (is_first ? message == part
                           : message.compare(message.size() - part.size(),
                                             std::string::npos,
                                             part) == 0);
        const auto found = message.find(part, at);
        if (found == std::string::npos || (is_first && found != 0))
          return false;
        at    = found + part.size();
        begin = end + dots.size();
      }
  }



  inline std::string current;

  inline void
  out_of_time(int)
  {
    const std::string text = "FAILED: out of time: " + current + "\n";
    if (write(STDOUT_FILENO, text.c_str(), text.size()) < 0)
      _exit(4);
    _exit(3);
  }



  /// The answer to a case, from all processes.
  inline std::vector<std::string>
  answers_to(const Case &c)
  {
    RunOptions options;
    options.settings = c.settings;
    // The header is that of a good run.
    std::streambuf *const buffer  = std::cout.rdbuf(nullptr);
    std::string           message = "accepted";
    alarm(time_limit);
    try
      {
        run_simulations(c.run, MPI_COMM_WORLD, options);
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    const auto messages = Utilities::MPI::all_gather(MPI_COMM_WORLD, message);
    alarm(0);
    std::cout.rdbuf(buffer);
    std::cout.clear();
    std::cout.width(0);
    return messages;
  }
} // namespace refusals



/// Run the cases of the bases that are wanted. If the test has an argument,
/// only those that have it in their title; their messages are printed.
inline void
check_refusals(const std::function<bool(const std::string &)> &is_wanted)
{
  using namespace refusals;
  const bool is_first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  const bool is_parallel = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;
  const auto [bases, cases] = read_table(SOURCE_DIR "/refusals.txt");
  std::signal(SIGALRM, out_of_time);
  if (is_first)
    for (const auto &[name, text] : bases)
      std::ofstream(name + ".prm") << text;
  for (const Case &c : cases)
    {
      current = c.base + ", " + c.title;
      if (!is_wanted(c.base) ||
          (!test_arguments().empty() &&
           current.find(test_arguments()[0]) == std::string::npos))
        continue;
      MPI_Barrier(MPI_COMM_WORLD);
      if (is_first)
        write_files(c);
      MPI_Barrier(MPI_COMM_WORLD);
      const auto         messages = answers_to(c);
      const std::string &wanted =
        is_parallel && !c.message_of_two.empty() ? c.message_of_two : c.message;
      if (is_first)
        {
          check(current + ": " + messages[0], fits(messages[0], wanted));
          check(current + ": " + messages[0] + " and " + messages.back(),
                std::count(messages.begin(), messages.end(), messages[0]) ==
                  std::ptrdiff_t(messages.size()));
          for (const std::string &file : c.files_left)
            check(current + " leaves " + file, std::filesystem::exists(file));
        }
      if (!test_arguments().empty())
        print() << current << "\n" << messages[0] << std::endl;
    }
}

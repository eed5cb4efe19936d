// SPDX-License-Identifier: LGPL-2.1-or-later
// All: 1
// Debug: no

// Checks that wrong input yields one message that names the mistake. Every line
// of the shipped files in turn is removed, misspelled, and given wrong values.
// Each case must run, or its message must name the parameter, its section or
// its line. The only other result: soil of an enormous density finds no
// equilibrium.
//
// Runs a sample of about 200 cases without arguments. scripts/check_input calls
// it with arguments:
//
//   check_input FIRST STRIDE LOG [TEXT]
//
// This runs every STRIDE-th case from FIRST on, with a line in LOG for each;
// with TEXT only cases with TEXT in their name. A case is written to LOG.at
// before it runs, to name it after a crash.
#include <greville/benchmark/benchmark.h>
#include <greville/run/run.h>

#include "../shipped_files.h"
#include "simulation.h"
#include <boost/property_tree/json_parser.hpp>
#include <csignal>
#include <cstring>
#include <unistd.h>

namespace
{
  // Seconds after which a case has failed.
  constexpr unsigned int time_limit = 120;

  struct Case
  {
    std::string base, section, name, value, content;
    bool        is_benchmark = false;
    /// Of the command line.
    std::vector<std::string> settings;
  };



  /// The values that replace the value of a line.
  std::vector<std::string>
  wrong_values(const std::string &value)
  {
    return {"",
            "-1",
            "0",
            "1e300",
            "-1e300",
            "99999999999",
            "1e-300",
            "nan",
            "inf",
            "abc",
            "0x10",
            "1 kg",
            value + "x",
            value + ", 1",
            value + "; 1",
            value + " +",
            "sin(",
            "1/0",
            "sqrt(-1)",
            "x = 3",
            "0,5",
            "0,5; 0",
            "1/0; 0",
            "sqrt(-1); 0",
            "1e300; 1e300",
            "x = 3; 0",
            "100000, 100000"};
  }



  std::vector<Case>
  all_cases(const std::string &folder, const std::string &results)
  {
    std::vector<Case> cases;
    for (const ShippedFile &file : shipped_files(SOURCE_DIR, folder, results))
      {
        std::vector<std::string> lines, sections;
        std::istringstream       stream(file.content);
        for (std::string line; std::getline(stream, line);)
          lines.push_back(line);
        const auto add = [&](const std::string &section,
                             const std::string &name,
                             const std::string &value,
                             const std::string &content) {
          cases.push_back(
            {file.name, section, name, value, content, file.is_benchmark, {}});
        };
        const auto with = [&](const std::size_t k, const std::string &line) {
          std::string content;
          for (std::size_t i = 0; i < lines.size(); ++i)
            content += (i == k ? line : lines[i]) + "\n";
          return content + file.overrides;
        };
        std::string section;
        for (std::size_t k = 0; k < lines.size(); ++k)
          {
            std::string line = lines[k].substr(0, lines[k].find('#'));
            line             = Utilities::trim(line);
            if (line.compare(0, 11, "subsection ") == 0)
              {
                section = line.substr(11);
                add(section,
                    "",
                    "misspelled section",
                    with(k, "subsection " + section + "e"));
                add(section, "", "no name", with(k, "subsection"));
                add(section, "", "no section", with(k, ""));
              }
            else if (line == "end")
              {
                add(section, "", "no end", with(k, ""));
                add(section, "", "two ends", with(k, "end\nend"));
                add(section, "", "nonsense", with(k, "Hello\nend"));
              }
            else if (line.compare(0, 4, "set ") == 0)
              {
                const auto        equal = line.find('=');
                const std::string name =
                  Utilities::trim(line.substr(4, equal - 4));
                const std::string value =
                  Utilities::trim(line.substr(equal + 1));
                add(section, name, "removed", with(k, ""));
                add(section,
                    name,
                    "misspelled",
                    with(k, "set " + name + "s = " + value));
                add(section, name, "no value", with(k, "set " + name));
                // Last, so that what makes the file small does not win.
                const bool has_components =
                  value.find(';') != std::string::npos;
                for (const std::string &wrong : wrong_values(value))
                  if (has_components || wrong.find(';') == std::string::npos)
                    {
                      const bool is_setting = cases.size() % 2 == 0;
                      add(section,
                          name,
                          wrong,
                          with(k, lines[k]) +
                            (is_setting
                               ? ""
                               : section_text(section,
                                              {name + " = " + wrong})));
                      if (is_setting)
                        cases.back().settings = {section + "/" + name + "=" +
                                                 wrong};
                    }
              }
          }
      }
    return cases;
  }



  std::string current;

  extern "C" void
  out_of_time(int)
  {
    const std::string text = "FAILED: out of time: " + current + "\n";
    if (write(STDOUT_FILENO, text.c_str(), text.size()) < 0)
      _exit(4);
    _exit(3);
  }



  /// Check that all results of a run are numbers.
  std::string
  flaw_of_results(const std::string &results, const bool is_benchmark)
  {
    const std::string file =
      results + (is_benchmark ? "/solves.csv" : "/statistics.csv");
    std::ifstream in(file);
    std::string   line;
    while (std::getline(in, line))
      for (const std::string word : {",nan", ",-nan", ",inf", ",-inf"})
        // A solve that has failed says so in its column 'converged'.
        if (line.find(word) != std::string::npos &&
            line.find(",0," + word.substr(1)) == std::string::npos)
          return "numbers that are none in " + file + ": " + line;
    if (std::filesystem::exists(results + "/summary.json"))
      try
        {
          boost::property_tree::ptree tree;
          boost::property_tree::read_json(results + "/summary.json", tree);
        }
      catch (const std::exception &error)
        {
          return error.what();
        }
    return "";
  }



  /// Return the fault of a message; empty if there is none.
  std::string
  flaw_of_message(const std::string &message, const Case &c)
  {
    for (const char *raw : {"filesystem error",
                            "basic_string",
                            "map::at",
                            "std::",
                            "stod",
                            "stoul",
                            "vector::",
                            "Exc",
                            "violated",
                            "An error occurred"})
      if (message.find(raw) != std::string::npos)
        return "text of a library";
    for (const std::string &what :
         {c.section + "/" + c.name,
          "'" + c.name + "'",
          "'" + c.section + "'",
          "<" + c.section + "e>",
          "<" + c.section + "/" + c.name + "=",
          c.section == "Formulas" ? '"' + c.name + '"' : std::string(),
          std::string("Line "),
          std::string("ends no section"),
          std::string("has no 'end'")})
      if (what.size() > 2 && message.find(what) != std::string::npos)
        return "";
    // A formula of a name may ask for a motion that no step can follow.
    if (c.section == "Formulas" && message.compare(0, 5, "Step ") == 0)
      return "";
    // That nothing bears a weight or a load is found out by the run alone.
    if ((c.name == "Density" || c.section == "Walls") &&
        message.find("no equilibrium has been found") != std::string::npos)
      return "";
    return "it does not name the parameter";
  }
} // namespace



void
test_main()
{
  const std::string folder    = "check_input_files." + std::to_string(getpid());
  const std::string results   = folder + "/results";
  const auto        cases     = all_cases(folder, results);
  const auto       &arguments = test_arguments();
  const bool        is_sample = arguments.size() < 3;
  const std::size_t first     = is_sample ? 0 : std::stoul(arguments[0]);
  const std::size_t stride =
    is_sample ? cases.size() / 200 : std::stoul(arguments[1]);
  std::ofstream log;
  if (!is_sample)
    log.open(arguments[2], std::ios::app);
  std::signal(SIGALRM, out_of_time);

  unsigned int n = 0;
  for (std::size_t k = first; k < cases.size(); k += stride)
    {
      const Case &c = cases[k];
      current =
        c.base + ", " + c.section + ", " + c.name + " <" + c.value + ">";
      if (arguments.size() > 3 &&
          current.find(arguments[3]) == std::string::npos)
        continue;
      if (!is_sample)
        std::ofstream(std::string(arguments[2]) + ".at")
          << k << "\n"
          << current << std::endl;
      std::filesystem::remove_all(results);
      std::ofstream(folder + "/case.prm") << c.content;
      std::streambuf *const buffer  = std::cout.rdbuf(nullptr);
      std::string           message = "ran", flaw;
      alarm(time_limit);
      try
        {
          if (c.is_benchmark)
            Benchmark().run(folder + "/case.prm", c.settings);
          else
            {
              RunOptions options;
              options.settings = c.settings;
              run_simulations(folder + "/case.prm", MPI_COMM_WORLD, options);
            }
          if (std::filesystem::exists(results))
            flaw = flaw_of_results(results, c.is_benchmark);
        }
      catch (const std::exception &error)
        {
          message = message_of(error);
          flaw    = flaw_of_message(message, c);
        }
      alarm(0);
      std::cout.rdbuf(buffer);
      std::cout.clear();
      std::cout.width(0);
      ++n;
      if (log.is_open())
        log << k << "\t" << (flaw.empty() ? "good" : "BAD: " + flaw) << "\t"
            << current << "\t" << message << std::endl;
      else
        check(current + ": " + flaw + ": " + message, flaw.empty());
    }
  std::filesystem::remove_all(folder);
  check("there are cases",
        n >= (is_sample              ? 190
              : arguments.size() > 3 ? 0
                                     : 1));
  if (!is_sample)
    std::cout << n << " of " << cases.size() << " cases" << std::endl;
}

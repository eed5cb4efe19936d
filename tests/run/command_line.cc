// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks command lines of both programs that run no simulation or a tiny one:
// their output, and one message of the first process for wrong ones.
#include <greville/benchmark/benchmark_program.h>
#include <greville/run/simulation_program.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <tests.h>
#include <unistd.h>

namespace
{
  using Words = std::vector<std::string>;

  bool
  is_first()
  {
    return Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  }



  std::string
  content_of(const std::string &file)
  {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }



  void
  write(const std::string &file, const std::string &text)
  {
    if (is_first())
      std::ofstream(file) << text;
    MPI_Barrier(MPI_COMM_WORLD);
  }



  struct Answer
  {
    int         status = 0;
    std::string out, errors;
  };



  /// Run a command line, of which the first word is the program.
  Answer
  answer_to(const Words &words)
  {
    const Program program =
      words[0] == "greville" ? simulation_program() : benchmark_program();
    std::ostringstream    out, errors;
    std::streambuf *const out_buffer    = std::cout.rdbuf(out.rdbuf()),
                          *error_buffer = std::cerr.rdbuf(errors.rdbuf());
    Answer answer;
    answer.status =
      run_command_line(program, Words(words.begin() + 1, words.end()));
    std::cout.rdbuf(out_buffer);
    std::cerr.rdbuf(error_buffer);
    std::cout.width(0);
    MPI_Barrier(MPI_COMM_WORLD);
    answer.out    = out.str();
    answer.errors = errors.str();
    return answer;
  }



  std::string
  text_of(const Words &words)
  {
    std::string text;
    for (const std::string &word : words)
      text += (text.empty() ? "" : " ") + word;
    return text;
  }



  unsigned int
  count(const std::string &text, const std::string &word)
  {
    unsigned int n = 0;
    for (auto k = text.find(word); k != std::string::npos;
         k      = text.find(word, k + 1))
      ++n;
    return n;
  }



  /// Check that a command line ends well and prints all of @p wanted. Returns
  /// what it prints.
  std::string
  accept(const Words &words, const Words &wanted = {})
  {
    const Answer answer = answer_to(words);
    check(text_of(words) + " is accepted: " + answer.errors,
          answer.status == 0 && (answer.out.empty() || is_first()));
    if (is_first())
      for (const std::string &word : wanted)
        check("<" + word + "> of " + text_of(words) + ": " + answer.out,
              answer.out.find(word) != std::string::npos);
    return answer.out;
  }



  /// Check that a command line ends with 1 and prints @p message once.
  void
  refuse(const std::string &message, const Words &words)
  {
    const Answer       answer = answer_to(words);
    const std::string &errors = answer.errors;
    check(text_of(words) + " is refused: " + errors,
          answer.status == 1 && (errors.empty() || is_first()));
    if (is_first())
      check("one <" + message + "> of " + text_of(words) + ": " + errors,
            count(errors, message) == 1 && count(errors, "\n") == 1);
  }



  void
  check_options(const std::string &program)
  {
    const std::string help = accept({program, "--help"},
                                    {"Usage: ",
                                     "--set",
                                     "--print-parameters",
                                     "--list",
                                     "--completion",
                                     "--version"});
    if (is_first())
      {
        std::istringstream lines(help);
        unsigned int       n       = 0;
        std::size_t        longest = 0;
        for (std::string line; std::getline(lines, line); ++n)
          longest = std::max(longest, line.size());
        check("the help is a page", n <= 45 && longest <= 80);
      }
    check("-h", accept({program, "-h"}) == help);
    const std::string version = accept({program, "--version"}, {", deal.II "});
    check("version: " + version,
          !is_first() ||
            std::regex_search(version, std::regex("[0-9]\\.[0-9]\\.[0-9]")));

    refuse("There is no parameter file <no_such_file.prm>",
           {program, "no_such_file.prm"});
    refuse("The name of the parameter file is empty", {program, ""});
    refuse("is a folder, not a parameter file", {program, "."});
    refuse("there is no option <--foo>", {program, "--foo"});
    refuse("there is no parameter file to run", {program});
    refuse("takes one parameter file, not 2", {program, "a", "b"});
    if (geteuid() != 0)
      {
        write("unreadable.prm", "");
        std::filesystem::permissions("unreadable.prm",
                                     std::filesystem::perms::none);
        refuse("cannot be read: Permission denied",
               {program, "unreadable.prm"});
      }

    refuse("there is no option <--pritn-parameters>. Did you mean "
           "<--print-parameters>?",
           {program, "--pritn-parameters"});
    refuse("the option <--help> takes no value", {program, "--help=me"});
    refuse("needs a value: \"SECTION/PARAMETER=VALUE\"",
           {program, "a.prm", "--set"});
    refuse("--parameters takes no file", {program, "--parameters", "a.prm"});
    refuse("--list and --parameters exclude each other",
           {program, "--parameters", "--list"});
    refuse("--set is for a parameter file",
           {program, "--list", "--set", "A/B=1"});
    refuse("--completion supports only the shell bash, not <zsh>",
           {program, "--completion", "zsh"});
    accept({program, "--list"}, {"smoothers"});
    accept({program, "--list", "smoothers"}, {"ic0", "jacobi"});
    refuse("there is no list <smother>. Did you mean <smoothers>?",
           {program, "--list", "smother"});
  }



  void
  check_lists()
  {
    for (const auto &[name, words] : std::vector<std::pair<std::string, Words>>{
           {"materials", {"linear-elastic", "mohr-coulomb", "newtonian-fluid"}},
           {"shapes", {"box", "level_set", "difference"}},
           {"masses", {"auto", "consistent", "lumped", "fmpm-K"}},
           {"walls", {"sliding", "friction", "periodic"}},
           {"integrators", {"USL", "newmark"}},
           {"element-tests", {"triaxial-undrained"}},
           {"Grid", {"Order", "Lower corner"}},
           {"Grid/Order", {"default: 2", "a whole number between 1 and"}}})
      accept({"greville", "--list", name}, words);
    refuse("it is neither a section nor a parameter",
           {"greville", "--list", "nothing"});
    refuse("Did you mean <Contact NAME>?", {"greville", "--list", "Contact"});
    refuse("Did you mean <Rigid body NAME>?",
           {"greville", "--list", "rigid body plate"});
  }



  /**
   * Each template has a title of one line and takes its first steps on a
   * coarse grid (on one process). No file is overwritten.
   */
  void
  check_templates()
  {
    accept({"greville", "--new"},
           {"slope ",
            "cantilever_3d ",
            "A slope of soil",
            "under an end load (3D, total Lagrangian, implicit)"});
    std::map<std::string, std::string> cells;
    std::ifstream table(std::string(SOURCE_DIR) + "/../small_cells.txt");
    for (std::string name, numbers;
         table >> name && std::getline(table, numbers);)
      cells[name] = numbers;
    for (const ProgramTemplate &one : simulation_program().templates)
      {
        accept({"greville", "--new", one.name},
               {"Written: " + one.name + ".prm"});
        check(one.name + ".prm", content_of(one.name + ".prm") == one.content);
        check("the title of " + one.name, one.title().size() < 80);
        check("cells of " + one.name, cells.count(one.name) == 1);
        accept({"greville",
                one.name + ".prm",
                Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1
                  ? "--check"
                  : "--print-parameters",
                "--set=Grid/Cells=" + cells[one.name],
                "--set=Time/Maximum steps=1"});
      }
    write("mine.prm", "mine");
    refuse("There is a file <mine.prm> already",
           {"greville", "--new", "slope", "mine.prm"});
    check("mine.prm", content_of("mine.prm") == "mine");
    accept({"greville", "--new", "slope", "other.prm"}, {"Written: other.prm"});
    check("other.prm", content_of("other.prm") == content_of("slope.prm"));
    refuse("there is no template <slpoe>", {"greville", "--new", "slpoe"});
    refuse("there is no option <--new>", {"greville_benchmark", "--new"});
  }



  void
  check_printed_parameters()
  {
    // The defaults run as they are.
    write("all.prm", accept({"greville", "--print-parameters"}));
    accept({"greville",
            "all.prm",
            "--set",
            "Time/Maximum steps=3",
            "--set=Grid/Order=1"},
           {"3 steps"});
    check("the setting is in parameters.prm",
          std::regex_search(content_of("output/defaults/parameters.prm"),
                            std::regex("set Order *= 1")));
    accept(
      {"greville", "slope.prm", "--print-parameters", "--set", "Grid/Order=3"},
      {"set Order          = 3"});
    refuse("The option --set <Grid/Odrer=3>: in the section",
           {"greville", "slope.prm", "--set", "Grid/Odrer=3"});
    refuse("The option --set <Grid/Order=9>: the parameter",
           {"greville", "slope.prm", "--check", "--set", "Grid/Order=9"});
    // JSON and XML lead to the same values, with stages as well.
    for (const std::string name : {"slope", "excavation"})
      {
        const std::string first =
          accept({"greville", name + ".prm", "--print-parameters"});
        for (const std::string format : {"json", "xml"})
          {
            write(name + "." + format,
                  accept(
                    {"greville", name + ".prm", "--print-parameters", format}));
            check(name + "." + format,
                  accept(
                    {"greville", name + "." + format, "--print-parameters"}) ==
                    first);
          }
      }
    accept({"greville",
            "--print-parameters",
            "json",
            "slope.prm",
            "--set",
            "Grid/Order=3"},
           {"\"Order\": 3,"});
    accept({"greville", "--print-parameters=xml"}, {"<Upper_20corner>"});
    accept({"greville_benchmark", "--print-parameters", "xml"}, {"<Solvers>"});
    refuse("takes one of prm|json|xml, not <yaml>",
           {"greville", "slope.prm", "--print-parameters=yaml"});

    write("benchmark.prm",
          accept({"greville_benchmark", "--print-parameters"}));
    accept({"greville_benchmark",
            "benchmark.prm",
            "--set",
            "Benchmark/Cells=4",
            "--set",
            "Benchmark/Orders=2",
            "--set",
            "Benchmark/Output directory=solved"});
    check("the setting is in parameters.prm of the benchmark",
          std::regex_search(content_of("solved/parameters.prm"),
                            std::regex("set Orders *= 2")));
  }



  void
  check_checks()
  {
    const Words check_slope = {"greville", "slope.prm", "--check"};
    const auto  with        = [&](const std::string &setting) {
      Words words = check_slope;
      words.insert(words.end(), {"--set", setting});
      return words;
    };
    refuse("--draw is for the initial state",
           {"greville", "slope.prm", "--draw", "here"});
    refuse("is given twice", {"greville", "slope.prm", "--check", "--check"});
    refuse("--resume and --from exclude each other",
           {"greville", "slope.prm", "--resume", "--from", "there"});
    refuse("has no results to resume from", {"greville", "--resume", "."});

    // A check writes nothing.
    if (is_first())
      std::filesystem::remove_all("output");
    accept(with("Grid/Cells=45, 12"),
           {"number of steps: about", "estimated time: ", "memory: "});
    check("--check writes no results", !std::filesystem::exists("output"));
    // Numbers that look like those in other units.
    const std::string text =
      accept(check_slope, {"s waves, m/s", " 2000 ", " 82.0", " 43.8", " 751"});
    check("no note on usual numbers", count(text, "Note:") == 0);
    accept(with("Material soil/Density=20"), {"density of 20 kg"});
    accept(with("Material soil/Young modulus=1e4"),
           {"'Material soil' is soft"});
    accept(with("Material soil/Cohesion=8"), {"'Material soil' is weak"});

    write("ring.prm",
          "include slope.prm\nsubsection Grid\n  set Geometry = axisymmetric\n"
          "  set Cells = 45, 12\nend\n");
    accept({"greville", "ring.prm", "--check"}, {"mass, kg/rad"});

    // Several files: those that are refused do not keep others from being
    // checked.
    write("small.prm",
          "include slope.prm\nsubsection Grid\n  set Cells = 45, 12\nend\n");
    write("wrong.prm",
          "include small.prm\nsubsection Grid\n  set Order = 9\nend\n");
    accept(
      {"greville", "--check", "small.prm", "slope.prm"},
      {"Check of small.prm: ", "Check of slope.prm: ", "2 files, 0 refused"});
    const Answer answer = answer_to(
      {"greville", "wrong.prm", "small.prm", "nowhere.prm", "--check"});
    check("the status of several files", answer.status == 1);
    if (is_first())
      {
        check("the file behind one that is refused: " + answer.out,
              count(answer.out, "Check of ") == 1 &&
                count(answer.out, "Check of small.prm: ") == 1 &&
                count(answer.out, "\n3 files, 2 refused\n") == 1);
        check("the messages of several files: " + answer.errors,
              count(answer.errors, "\n") == 2 &&
                count(answer.errors,
                      "greville: wrong.prm: Line 3 of <wrong.prm>: the "
                      "parameter 'Grid/Order' is <9>") == 1 &&
                count(answer.errors,
                      "greville: nowhere.prm: There is no parameter file") ==
                  1);
      }
    else
      check("nothing else", answer.out.empty() && answer.errors.empty());
    refuse("takes one parameter file, not 2; --check takes several.",
           {"greville", "small.prm", "slope.prm"});
    refuse("takes one parameter file, not 2",
           {"greville", "small.prm", "slope.prm", "--print-parameters"});
    for (const Words &option :
         {Words{"--draw", "here"}, Words{"--from", "there"}, Words{"--resume"}})
      {
        Words words = {"greville", "small.prm", "slope.prm", "--check"};
        words.insert(words.end(), option.begin(), option.end());
        refuse(option[0] + " takes one parameter file, not 2.", words);
      }
  }



  void
  check_element_tests()
  {
    const Words test = {"greville",
                        "slope.prm",
                        "--set",
                        "Output/Directory=tested",
                        "--element-test"};
    const auto  with = [&](const Words &more) {
      Words words = test;
      words.insert(words.end(), more.begin(), more.end());
      return words;
    };
    accept(with({"triaxial-drained",
                 "--material",
                 "soil",
                 "--set",
                 "Element test/Steps=7",
                 "--set",
                 "Element test/Strain=0.1, 0.05"}),
           {"Element test triaxial-drained of soil",
            "largest q",
            "results: tested/element_test.csv"});
    const std::string table = content_of("tested/element_test.csv");
    check("rows of element_test.csv", count(table, "\n") == 16);
    check("columns of element_test.csv",
          std::regex_search(
            table.substr(0, table.find('\n')),
            std::regex("^strain_axial,strain_volumetric,strain_shear,p,q,"
                       "void_ratio,pore_pressure,.*plastic_strain")));
    MPI_Barrier(MPI_COMM_WORLD);
    accept(with({"simple-shear"}));
    check("the earlier element test is moved",
          std::filesystem::exists("tested/earlier_1/element_test.csv"));
    refuse("there is no material <sol> in <slope.prm>, which has: soil. Did "
           "you mean <soil>?",
           with({"oedometer", "--material", "sol"}));
    refuse("it has to be one of isotropic|oedometer", with({"odometer"}));
    refuse("--material is for --element-test",
           {"greville", "slope.prm", "--material", "soil"});
    refuse("leave out --check", with({"oedometer", "--check"}));
  }
} // namespace



void
test_main()
{
  // Beside the output of this test.
  const std::filesystem::path folder = "folder";
  if (is_first())
    std::filesystem::create_directory(folder);
  MPI_Barrier(MPI_COMM_WORLD);
  std::filesystem::current_path(folder);
  for (const std::string program : {"greville", "greville_benchmark"})
    check_options(program);
  check_lists();
  check_templates();
  check_printed_parameters();
  check_checks();
  check_element_tests();
}

// SPDX-License-Identifier: LGPL-2.1-or-later

// Passes texts of libFuzzer to the parser that the environment variable PARSER
// names (see scripts/fuzz). The parser must read a text or throw an exception
// of deal.II with a message. Anything else, such as an exception of the
// standard library, is a failure.

#include <deal.II/base/exceptions.h>

#include <greville/base/csv.h>
#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/geometry/level_set.h>
#include <greville/geometry/shape.h>
#include <greville/geometry/surface_shape.h>
#include <greville/run/checkpoint.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <unistd.h>

using namespace dealii;
using namespace greville;

namespace
{
  /// A file with a text, which later ones overwrite.
  std::string
  file_with(const std::string &text, const std::string &ending)
  {
    const std::string folder =
      std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp";
    const std::string file =
      folder + "/greville_fuzz_" + std::to_string(getpid()) + ending;
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }



  void
  parse_csv(const std::string &text)
  {
    read_csv(file_with(text, ".csv"), "Parameter", [](const CsvLine &line) {
      if (!line.is_header)
        for (unsigned int k = 0; k < 3; ++k)
          line.number(k, "name");
    });
  }



  void
  parse_polygons(const std::string &text)
  {
    read_surface<2>(file_with(text, ".csv"), "Parameter", 1e-3);
  }



  // As LevelSetShape does it, the formula is read as a shape before.
  template <int dim>
  void
  parse_shape(const std::string &text)
  {
    const Shape<dim>     shape(text, "Parameter");
    const ShapeTree<dim> tree(text, "Parameter");
    Point<dim>           x;
    x[0] = 0.3;
    shape.contains(x);
    for (const auto &level_set : tree.level_sets())
      level_set.value(x);
  }



  void
  parse_checkpoint(const std::string &text)
  {
    const std::size_t middle = text.find('\0');
    describe_changes(text.substr(0, middle),
                     middle == std::string::npos ? ""
                                                 : text.substr(middle + 1));
  }



  /// Read a file and an option --set by a program with few parameters.
  void
  parse_parameters(const std::string              &content,
                   const std::vector<std::string> &settings)
  {
    ParameterHandler prm;
    double           number = 1.;
    unsigned int     count  = 2;
    std::string      word   = "one";
    std::vector<int> list   = {1, 2};
    prm.add_parameter("Number", number, "", Patterns::Double(0.));
    prm.enter_subsection("Section");
    prm.add_parameter("Count", count);
    prm.add_parameter("List", list);
    prm.enter_subsection("Inner");
    prm.add_parameter("Word", word, "", Patterns::Selection("one|two"));
    prm.leave_subsection();
    prm.leave_subsection();
    parse_parameter_lines(prm,
                          read_parameter_lines(file_with(content, ".prm"),
                                               "Section",
                                               {"Other"},
                                               "other program",
                                               settings));
  }



  using Parser = void (*)(const std::string &);

  const std::map<std::string, Parser> parsers = {
    {"csv", &parse_csv},
    {"polygons", &parse_polygons},
    {"shape_2d", &parse_shape<2>},
    {"shape_3d", &parse_shape<3>},
    {"checkpoint", &parse_checkpoint},
    {"parameters", [](const std::string &t) { parse_parameters(t, {}); }},
    {"settings", [](const std::string &t) {
       parse_parameters("subsection Section\nend\n", {t});
     }}};

  Parser parser = nullptr;
} // namespace



extern "C" int
LLVMFuzzerInitialize(int *, char ***)
{
  const char *name  = std::getenv("PARSER");
  const auto  found = parsers.find(name == nullptr ? "" : name);
  if (found == parsers.end())
    {
      std::cerr << "PARSER has to be one of";
      for (const auto &known : parsers)
        std::cerr << " " << known.first;
      std::cerr << "." << std::endl;
      std::exit(2);
    }
  parser = found->second;
  return 0;
}



extern "C" int
LLVMFuzzerTestOneInput(const unsigned char *data, const std::size_t size)
{
  try
    {
      parser(std::string(reinterpret_cast<const char *>(data), size));
    }
  catch (const ExceptionBase &error)
    {
      if (message_of(error).empty())
        std::abort();
    }
  return 0;
}
